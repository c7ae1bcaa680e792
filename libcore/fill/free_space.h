#pragma once

#include "fill/fill_holes.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace quoin {

struct SurfacePoint {
    Eigen::Vector3d p_world;
    double area = 0.0; // that it stands for [m^2]
};

// For every point, the number of keyframes whose depth lies behind it, by more than the tolerance and all around the
// pixel: their rays have passed through.
std::vector<std::uint32_t> rays_through(const std::vector<SurfacePoint>& points, const FillHolesInput& input,
                                        const FillHolesParams& params);

} // namespace quoin
