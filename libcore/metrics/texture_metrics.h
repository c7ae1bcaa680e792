#pragma once

#include "metrics/evaluate.h"
#include "metrics/metric_list.h"

namespace quoin {

// Where the colours of the textured surface come from, by area: of all of it, and of what the keyframes saw. How full
// the atlas is. How much the colour steps at borders between planes, and from texel to texel inside planes (border_step
// and inner_step: median difference of luma, 0..255, between photographed points half a texel to either side of an
// edge). Requires a textured mesh.
void add_texture_metrics(MetricList& list, const Evaluated& inputs, const EvaluateParams& params);

} // namespace quoin
