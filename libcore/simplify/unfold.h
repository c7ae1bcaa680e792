#pragma once

#include "simplify/simplify.h"

namespace quoin {

// Contracts and flips edges where faces are folded onto each other, look away from their plane or have no area, as long
// as these become fewer and the surface moves by at most params.max_fold_error. Tips of thin sheets, strips that two
// planes both filled, and ragged faces off their plane go, with their plane where that is a single such face; sheets
// that are larger keep their folds. The mesh stays manifold.
void unfold(PlaneMesh& mesh, const SimplifyParams& params);

} // namespace quoin
