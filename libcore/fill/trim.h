#pragma once

#include "mesh/plane_mesh.h"

namespace quoin {

// Takes out again what spoils the mesh of the faces from `first` on, which close holes: faces that look away from their
// plane or are folded onto a neighbour; of two new faces that are folded onto each other the smaller one. Faces that
// hang together with no others of their plane go over to a plane beside them that has them within `distance` [m] and on
// its side, or go too. Where new faces then touch the rest in a vertex alone, they get one of their own; vertices
// without faces are dropped. Faces below `first` stay as they are, and their vertices too.
void trim_patches(PlaneMesh& mesh, FaceId first, double distance);

} // namespace quoin
