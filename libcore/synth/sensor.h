// The errors of a real sensor; every one vanishes at 0.
#pragma once

#include "mesh/ground_truth.h"
#include "synth/render_view.h"
#include "synth/synthesize.h"

#include <vector>

namespace quoin {

inline constexpr double kGrazingFade = 10.0; // below the grazing limit, where pixels begin to be missing [deg]

struct FrameErrors {
    Rigid true_from_recorded = Rigid::Identity(); // of the pose, in the camera's frame
    TrueExposure exposure;
    Eigen::Vector3d spin = Eigen::Vector3d::Zero(); // turn of the camera during the exposure [rad]; zero = sharp
};

// The slow errors of all frames: drift of pose, exposure and white balance, and which frames are blurred.
std::vector<FrameErrors> draw_frame_errors(const SynthParams& params);

// The poses during an exposure, about one a pixel of blur.
std::vector<View> exposure_views(const View& view, const Eigen::Vector3d& spin);

// Exposure, vignetting, noise and rounding.
ColorImage expose(const ColorField& truth, const TrueExposure& exposure, const SynthParams& params,
                  std::uint64_t frame);

// Noise, quantisation, holes and range; in millimetres, 0 = missing.
Image<std::uint16_t> sense_depth(const ExactDepth& truth, const SynthParams& params, std::uint64_t frame);

} // namespace quoin
