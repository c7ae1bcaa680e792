#pragma once

#include "mesh/triangle_mesh.h"

#include <cstddef>

namespace quoin {

// A mesh for looking at with at most about `max_faces` faces: vertices within a cell of a grid become their mean, with
// its colour, and faces that lose a corner vanish. A mesh that is small enough stays as it is. Normals are dropped.
TriangleMesh coarsen(const TriangleMesh& mesh, std::size_t max_faces);

} // namespace quoin
