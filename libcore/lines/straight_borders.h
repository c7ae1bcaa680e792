// The straight pieces of the borders between planes.
#pragma once

#include "mesh/plane_mesh.h"

#include <array>
#include <vector>

namespace quoin {

struct StraightBorder {
    std::array<PlaneId, 2> planes{};       // the smaller id first
    std::array<Eigen::Vector3d, 2> ends{}; // of the fitted line, world [m]
};

struct BorderLimits {
    double min_angle = 0.0;  // between the planes, without regard to their sides [rad]
    double min_length = 0.0; // [m]
    double max_gap = 0.0;    // over which a border goes on [m]
    double max_rms = 0.0;    // of the border's vertices to its line [m]
};

// Chains border edges by pair of planes into polylines, cuts these where they leave the line through them, and fits a
// line to each piece. In the order of the planes.
std::vector<StraightBorder> straight_borders(const PlaneMesh& mesh, const BorderLimits& limits);

} // namespace quoin
