// Figures against the ground truth. Models are given in the truth's world.
#pragma once

#include "metrics/evaluate.h"
#include "metrics/metric_list.h"

namespace quoin {

// Normal and offset of every true plane's match: the model's plane that most of its points lie on.
void add_plane_metrics(MetricList& list, const PlaneMesh& model, const GroundTruth& truth,
                       const EvaluateParams& params);

// Where edges between the model's planes lie and how they turn, against the creases that the scan saw.
void add_crease_metrics(MetricList& list, const PlaneMesh& model, const GroundTruth& truth,
                        const EvaluateParams& params);

// Poses of the scan and of the alignment, and exposure gains up to one factor a channel. Throws InputError when the
// truth has another number of frames than the scan.
void add_pose_metrics(MetricList& list, const Evaluated& inputs);
void add_exposure_metrics(MetricList& list, const Evaluated& inputs);

// Colours at true surface points, after one affine fit: of the texture, and of the dense mesh's vertices.
void add_true_color_metrics(MetricList& list, const TexturedMesh* textured, const TriangleMesh* dense,
                            const GroundTruth& truth, const EvaluateParams& params);

} // namespace quoin
