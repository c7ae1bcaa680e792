#pragma once

#include "simplify/curves.h"
#include "simplify/simplify.h"

namespace quoin {

// Straightens what labels made ragged: a face with two of its edges on the border to one other plane, within
// params.snap_distance of it and facing as it does, goes over to that plane; no plane loses its last face. Classes are
// as they were.
void trim_ears(PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite, const SimplifyParams& params);

// Moves every vertex by at most params.snap_distance onto its plane, the line or the corner where its planes meet,
// unless that would turn a face over. Vertices further away stay.
void snap_to_planes(PlaneMesh& mesh, const SimplifyParams& params);

// The same for the vertices of curves and those of the faces of `part`: a mesh with the vertices and planes of the one
// that the curves were traced on, and some of its faces, which must not turn over.
void snap_curves(const Curves& curves, PlaneMesh& part, const SimplifyParams& params);

} // namespace quoin
