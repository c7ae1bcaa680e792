// When a face has no area.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace quoin {

using Triangle = std::array<Eigen::Vector3d, 3>;

// Vertices are written as floats, whose rounding turns a face as low as this any way.
constexpr double kZeroHeight = 1e-6; // [m]

inline double longest_edge(const Triangle& t)
{
    return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

inline bool has_area(const Triangle& t)
{
    return (t[1] - t[0]).cross(t[2] - t[0]).norm() > kZeroHeight * longest_edge(t);
}

} // namespace quoin
