#pragma once

#include "metrics/evaluate.h"
#include "metrics/metric_list.h"

namespace quoin {

// Held-out photographs against views of the textured model (views.model) and of the dense mesh's vertex colours
// (views.dense), each from its own refined pose. A pixel counts where every model given covers it: shows something, not
// far from the measured depth; "charged" figures are over those and all pixels with a measured depth (of a view without
// depth, all that a model covers), which are black where the model does not cover them, so that leaving surface out
// never wins. "Shown" figures are over the same pixels as a viewer sees them: black only where there is nothing.
void add_view_metrics(MetricList& list, const Evaluated& inputs, const EvaluateParams& params);

} // namespace quoin
