#pragma once

#include "simplify/simplify.h"

namespace quoin {

// Straightens what labels made ragged: a face with two of its edges on the border to one other plane, within
// params.snap_distance of it, goes over to that plane; no plane loses its last face. Classes must be found anew
// afterwards.
void trim_ears(PlaneMesh& mesh, const SimplifyParams& params);

// Moves every vertex by at most params.snap_distance onto its plane, the line or the corner where its planes meet,
// unless that would turn a face over. Vertices further away stay.
void snap_to_planes(PlaneMesh& mesh, const SimplifyParams& params);

} // namespace quoin
