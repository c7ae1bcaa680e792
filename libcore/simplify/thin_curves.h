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

// Joins neighbouring vertices of curves, curves in parallel, while they stay within the errors; corners do not move.
// Faces are not looked at.
class CurveThinner {
public:
    // The curves' positions are those of the vertices of the mesh [m]; all of these are kept by reference, and curves
    // and positions follow.
    CurveThinner(const PlaneMesh& planes, Curves& curves, std::vector<Eigen::Vector3d>& position,
                 const SimplifyParams& params);

    void thin(std::span<const CurveId> which, const CurveBounds& bounds);

private:
    Curves& curves_;
    std::vector<Eigen::Vector3d>& position_;
    const CurveFit fit_;
    std::vector<Quadric> quadric_;        // one per slot; each curve touches its own
    std::vector<Eigen::Vector3d> target_; // one per slot, of the edge that begins there
    std::vector<std::uint32_t> version_;  // one per slot
};

} // namespace quoin
