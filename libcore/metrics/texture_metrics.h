#pragma once

#include "metrics/evaluate.h"
#include "metrics/metric_list.h"

namespace quoin {

// Where the colours of the textured surface come from, by area: of all of it, and of what the keyframes saw. How full
// the atlas is, and what there is at its borders (border_metrics.h). Requires a textured mesh.
void add_texture_metrics(MetricList& list, const Evaluated& inputs, const EvaluateParams& params);

} // namespace quoin
