// Builds what a solver minimises: which texels, depths and lines are compared, and what may move.
#pragma once

#include "alignment/energy.h"

namespace quoin {

// Texels: every one, those that are not held out, or of these the ones with the largest gradients.
enum class TexelChoice { All, Fitted, Selected };

struct ProblemSource {
    const AlignmentScene& scene;
    AlignmentState input; // where the priors pull to
    double lambda_p = 0.0;
    DepthSamples
        depths; // chosen once, at the input poses: a list that follows the poses would drop what contradicts them
    std::vector<LineObservation> lines;
    DepthSamples line_depths;
    bool color_camera_is_free = false;
};
ProblemSource problem_source(const AlignmentScene& scene, const Keyframes& keyframes, const LineMatches& lines,
                             const AlignmentState& input);

// Input poses, planes about the centres of their clusters, no change of exposure.
AlignmentState input_state(const Scan& scan, const Keyframes& keyframes, const PlaneMesh& mesh);

// The texels that `state` sees on a grid of `spacing` [m] at a pyramid level.
AlignmentProblem make_problem(const ProblemSource& source, const AlignmentState& state, int level, double spacing,
                              TexelChoice choice);

} // namespace quoin
