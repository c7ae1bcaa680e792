#pragma once

#include "metrics/evaluate.h"
#include "metrics/metric_list.h"
#include "render/textured.h"

namespace quoin {

// How much colour steps at borders between planes, and inside planes at edges between faces of one chart, between
// photographed points half a texel to either side. Differences of luma, 0..255; medians over places crease_step apart.
//   border_contrast, inner_contrast  in the texture: detail, true changes of colour, and seams
//   border_step, inner_step          what the baking added: the texture's difference less that of the same two points
//                                    in the keyframe that sees both best, in the common exposure, averaged with its
//                                    sign over stretches of edge, for a seam keeps its sign and noise does not. Inside
//                                    planes there are no seams: inner_step is what noise and poses leave. Left out
//                                    without images; points that no keyframe sees together do not count.
// Requires a textured mesh.
void add_border_metrics(MetricList& list, const TexturedModel& model, const Evaluated& inputs,
                        const EvaluateParams& params);

} // namespace quoin
