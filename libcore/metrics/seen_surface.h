// What of a surface the keyframes could photograph.
#pragma once

#include "metrics/evaluate.h"
#include "metrics/surface.h"

#include <span>

namespace quoin {

// One per sample of the light model: 1 = at least one keyframe sees it, from its aligned pose. A keyframe sees a point
// that lies in its colour image, between seen_min_depth and seen_max_depth, on a face that turns its front to the
// camera by no more than seen_angle, with nothing of the model nearer and nothing of the measured depth elsewhere: by
// depth_tolerance, as in held-out views. Unlike the baking, this asks for no distance from edges of depth or of the
// image, and for no measured depth. Requires scan, images, keyframes and alignment that belong together.
std::vector<std::uint8_t> seen_by_keyframes(std::span<const SurfaceSample> samples, const Evaluated& inputs,
                                            const EvaluateParams& params);

} // namespace quoin
