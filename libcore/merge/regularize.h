// Directions of planes that were probably meant to be parallel or orthogonal.
#pragma once

#include "merge/merge.h"

#include <array>
#include <span>
#include <utility>

namespace quoin {

// A weak prior: every plane turns about its centroid to where its own faces and the directions of better known planes
// agree best. A plane's faces tell its normal up to the angle that params.regular_depth makes across its extent, so
// narrow strips turn easily and walls hardly. Directions come from neighbours, and from everywhere by planes of
// params.regular_area or more; those count that are parallel or orthogonal within the uncertainty of both planes, and
// what they say deviates by params.regular_angle. neighbours: pairs of planes with a common border.
std::vector<Plane> regularize(const std::vector<Plane>& plane, const std::vector<Moments>& moments,
                              std::span<const std::pair<PlaneId, PlaneId>> neighbours, const MergeParams& params);

} // namespace quoin
