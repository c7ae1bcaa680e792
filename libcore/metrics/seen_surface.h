// What of a surface the keyframes could photograph.
#pragma once

#include "metrics/evaluate.h"
#include "metrics/surface.h"

#include <span>

namespace quoin {

// One per sample of the light model: 1 = at least one keyframe sees it (KeyframeSight). Requires scan, images,
// keyframes and alignment that belong together.
std::vector<std::uint8_t> seen_by_keyframes(std::span<const SurfaceSample> samples, const Evaluated& inputs,
                                            const EvaluateParams& params);

} // namespace quoin
