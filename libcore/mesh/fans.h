// Fans: faces around a vertex that hang together over their edges at it.
#pragma once

#include "mesh/triangle_mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace quoin {

// Gives each fan a vertex of its own where fans touch in a vertex only: the fan of the smallest corner keeps it, copies
// come behind all vertices in the order of those corners. Edges of three or more faces hold no fan together. opposite:
// opposite_half_edges(mesh), which stays as it is. Returns the number of vertices added.
std::size_t split_touching_fans(TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite);

} // namespace quoin
