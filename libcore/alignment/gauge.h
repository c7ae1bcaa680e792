// The gauge of the alignment: photographs and depths do not say where the whole of cameras and planes lies in the
// world.
#pragma once

#include "alignment/plane_term.h"

namespace quoin {

// Moves cameras and planes together, rigidly, to where the planes lie closest to the dense clusters that they were
// fitted to (least squares over `scatter`, one a plane). What cameras see of planes stays as it is; so do colours and
// depths.
AlignmentState returned_to_mesh(AlignmentState state, const std::vector<PlaneScatter>& scatter);

} // namespace quoin
