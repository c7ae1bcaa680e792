#pragma once

#include "simplify/curve_fit.h"

#include <span>

namespace quoin {

using CurveId = std::uint32_t;

// What holds curves back beside the errors of the parameters.
struct CurveBounds {
    std::vector<float> tolerance;          // one per slot, scales the errors
    std::vector<std::uint8_t> least_edges; // one per curve
};

// Joins neighbouring vertices of the given curves, curves in parallel, while they stay within the errors; corners do
// not move. Faces are not looked at. `fit` is made of these curves and positions, of the vertices of the mesh [m]; both
// follow.
void thin_curves(const CurveFit& fit, std::span<const CurveId> which, const CurveBounds& bounds, Curves& curves,
                 std::vector<Eigen::Vector3d>& position);

} // namespace quoin
