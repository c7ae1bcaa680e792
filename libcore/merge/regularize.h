// Directions of planes that were probably meant to be parallel or orthogonal.
#pragma once

#include "merge/merge.h"

#include <span>
#include <utility>

namespace quoin {

// A weak prior: strips, whose direction is known along them but not across, turn about their centroids to where their
// own faces and the directions of better known planes agree best. Faces tell a normal up to the angle that
// params.regular_depth makes across their extent. Directions come from neighbours, and from everywhere by planes of
// params.regular_area or more; those count that are parallel or orthogonal within the uncertainty of both planes, and
// are so with a standard deviation of params.regular_angle. Fusion lays the sides of boards and frames aslant; these,
// which lead from one plane to a parallel one, turn as far as it takes, others by params.regular_move. neighbours:
// pairs of planes with a common border.
std::vector<Plane> regularize(const std::vector<Plane>& plane, const std::vector<Moments>& moments,
                              std::span<const std::pair<PlaneId, PlaneId>> neighbours, const MergeParams& params);

} // namespace quoin
