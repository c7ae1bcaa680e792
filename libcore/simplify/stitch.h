#pragma once

#include "mesh/plane_mesh.h"

namespace quoin {

// Planes are filled apart, so two of them may both have drawn an edge between the same vertices, or the same face.
// Splits such edges inside all planes but one, and inside all where a border runs between these vertices, and such
// faces, at a new vertex. No border is touched.
void split_shared_chords(PlaneMesh& mesh);

} // namespace quoin
