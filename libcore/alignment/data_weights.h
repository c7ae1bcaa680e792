// How exact greys and depths are, by what the residuals of an aligned scan show. Exact data outweigh the pull to the
// input, whose errors have bent the dense mesh, too; depths that no poses and planes explain do not.
#pragma once

#include "alignment/energy.h"

namespace quoin {

// From the residuals of a state; of greys never less than the parameters give.
DataWeights estimated_weights(const AlignmentProblem& problem, const AlignmentState& state);

} // namespace quoin
