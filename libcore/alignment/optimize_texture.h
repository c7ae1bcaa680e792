// Finds the camera poses, planes and exposures under which every point of every plane has one colour: E_c + lambda_p
// E_p + lambda_t E_t (Wang and Guo 2019), and lambda_d E_d against the raw depth.
#pragma once

#include "alignment/params.h"
#include "alignment/scene.h"
#include "mesh/line_matches.h"
#include "scan/alignment.h"

namespace quoin {

// Requires poses of all keyframes, and a plane and moments for every plane id. The result's mean energy over one fixed
// set of observations is not larger than the input's: otherwise, and for every single frame that cannot be aligned, the
// input poses stay, with a warning. No keyframes, one keyframe, no texture or no depth are all allowed. Throws
// UsageError when min_depth >= max_depth, and what reading the images throws.
Alignment optimize_texture(const ScanImages& images, const Keyframes& keyframes, const PlaneMesh& mesh,
                           const LineMatches& lines, const OptimizeTextureParams& params);

// The same with images from anywhere.
struct AlignmentInput {
    const Scan& scan;
    ImageReader read;
    const Keyframes& keyframes;
    const PlaneMesh& mesh;
    const LineMatches& lines;
};
Alignment optimize_texture(const AlignmentInput& input, const OptimizeTextureParams& params);

} // namespace quoin
