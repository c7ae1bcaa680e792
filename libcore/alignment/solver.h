// The two ways to minimise the energy of a problem. Neither ends with a larger energy than it began with.
#pragma once

#include "alignment/energy.h"

#include <functional>

namespace quoin {

// Levenberg-Marquardt over poses, planes and calibration together, texel colours eliminated; exposures in between.
AlignmentState minimize_jointly(const AlignmentProblem& problem, AlignmentState state);

using OnIteration = std::function<void(const AlignmentState&)>;

// The paper's schedule: outer_loops times pose_loops steps of all poses, plane_loops steps of all planes, then new
// colours. Every block keeps a step only if its own energy falls.
AlignmentState minimize_alternating(const AlignmentProblem& problem, AlignmentState state,
                                    const OnIteration& on_iteration);

} // namespace quoin
