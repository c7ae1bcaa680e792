// The colour term E_c: a texel must look the same in every frame that sees it.
#pragma once

#include "alignment/observations.h"

namespace quoin {

// r = gain I(pi(p)) + bias, the corrected grey of a texel in a frame, and its derivatives; grey 0..1.
struct PhotometricRow {
    double value = 0.0;              // corrected grey
    Twist pose = Twist::Zero();      // by (omega, v) of the frame
    Vector3 plane = Vector3::Zero(); // by (alpha, s) of the texel's plane
    CalibrationStep calibration = CalibrationStep::Zero();
};

// A frame at a level, ready to be sampled.
struct FrameSampler {
    const GrayImage& gray;
    Camera camera; // of `gray`
    double scale;  // pixels of `gray` per pixel of the full image
    Rigid camera_from_world, color_from_depth;
    Exposure exposure;
};
FrameSampler frame_sampler(const AlignmentScene& scene, const AlignmentState& state, std::size_t frame, int level);

// A point outside the image takes the colour of its border, with no derivative: the energy keeps its set of terms.
PhotometricRow photometric_row(const FrameSampler& frame, const CenteredPlane& plane, const TangentBasis& tangents,
                               const Vector3& p_world);

// Grey of every observation as its frame shows it, not corrected by the exposure.
std::vector<float> observed_grays(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                  const Observations& observations, int level);

// Texel colours that minimise the robust cost: their means to begin with, then `rounds` of reweighting by Huber's
// weight at `delta`. Each round lowers the cost.
std::vector<float> texel_colors(const Observations& observations, const std::vector<float>& gray, double delta,
                                int rounds);

} // namespace quoin
