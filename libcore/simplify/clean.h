#pragma once

#include "mesh/plane_parts.h"
#include "simplify/simplify.h"

namespace quoin {

// Vertices in one cell of a grid of params.weld_distance become one; faces that repeat a vertex, have a vertex that is
// not finite, or the same vertices as an earlier face are dropped. Vertices are split until every edge has at most two
// faces and every vertex one fan: at an edge of more faces those of one plane stay together, then those around one
// inside. Classes are as they were. Returns the opposites of the half-edges.
std::vector<std::uint32_t> clean_input(PlaneMesh& mesh, const SimplifyParams& params);

// Splits vertices like clean_input(). Where a plane fell into parts, all but the largest go over to a plane beside them
// that explains them within params.snap_distance, or become planes of their own. Drops vertices and planes without
// faces, renumbering in order, and finds classes anew.
void finish(PlaneMesh& mesh, const SimplifyParams& params, PlaneParts parts);

} // namespace quoin
