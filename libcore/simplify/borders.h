#pragma once

#include "simplify/curves.h"
#include "simplify/simplify.h"

namespace quoin {

// Contracts edges along the curves of the mesh; vertex ids stay. Corners do not move. A curve stays within
// params.max_error [m] of where it was traced out of either plane, and within params.max_border_shift inside them; a
// mesh border within params.max_open_error in any direction.
std::size_t simplify_borders(PlaneMesh& mesh, Curves& curves, const SimplifyParams& params);

} // namespace quoin
