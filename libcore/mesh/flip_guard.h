// Moving vertices without turning faces over.
#pragma once

#include "mesh/plane_mesh.h"

namespace quoin {

// Pulls moved vertices of `mesh` back towards where they were in `before` (V), until every face looks along its plane's
// normal with a cosine of at least `min_cosine`, or no worse than it did before. Vertices go back by halves, `halvings`
// times, then all the way, so it ends: at worst with the mesh as it was. Returns how many vertices were held back.
std::size_t hold_back_flips(PlaneMesh& mesh, const std::vector<Eigen::Vector3f>& before, double min_cosine,
                            int halvings = 3);

} // namespace quoin
