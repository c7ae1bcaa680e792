// Moving vertices without turning faces over, folding them onto each other or flattening them to lines.
#pragma once

#include "mesh/plane_mesh.h"

namespace quoin {

struct FlipLimits {
    double min_cosine = 0.0;     // between a face and its plane
    double folded_cosine = -0.5; // between two faces on one edge
    double min_shape = 0.01;     // height over longest edge of a face
};

// Pulls moved vertices of `mesh` back towards where they were in `before` (V), until every face and every edge of two
// faces keeps to the limits, or was beyond them before: such a face looks away no farther than then and keeps half its
// shape. Vertices go back by halves, `halvings` times, then all the way, so it ends: at worst with the mesh as it was.
// Returns how many vertices were held back.
std::size_t hold_back_flips(PlaneMesh& mesh, const std::vector<Eigen::Vector3f>& before, const FlipLimits& limits,
                            int halvings = 3);

} // namespace quoin
