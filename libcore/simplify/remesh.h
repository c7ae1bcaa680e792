#pragma once

#include "simplify/simplify.h"

namespace quoin {

// Borders are simplified once for the planes on both sides, then every plane is filled with a constrained Delaunay
// triangulation: no face inside a plane can look away from it, and none is there that its border does not ask for.
// Planes that do not explain their faces (max_inner_error), and knots of the others, where their borders cross when
// seen along the normal, are simplified by quadrics. Requires a manifold mesh; returns one up to fans that touch,
// without classes.
PlaneMesh remesh(PlaneMesh mesh, std::vector<std::uint32_t> opposite, const SimplifyParams& params);

} // namespace quoin
