#pragma once

#include "mesh/plane_mesh.h"

namespace quoin {

// Where faces of one plane hang together over no edge, the largest part keeps the plane. The others go over to the
// plane behind their longest border that has them within `distance` [m] and on its side, or become planes of their own,
// with the moments of their faces, behind all others.
void separate_parts(PlaneMesh& mesh, double distance);

} // namespace quoin
