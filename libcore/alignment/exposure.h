// A gain and a bias per frame, so that automatic exposure and white balance are not taken for motion or for texture.
#pragma once

#include "alignment/observations.h"

namespace quoin {

// Exposures under which all frames see the same texel colours: one robust linear system of all frames with the colours
// eliminated and a prior to gain 1 and bias 0. Their mean log gain and their mean bias are those of no change at all,
// 0. `observed` is one channel, 0..1, of every observation. Frames without observations keep gain 1 and bias 0. The
// first weights are those of the exposures `start`, one a frame.
std::vector<Exposure> estimate_exposures(const Observations& observations, const std::vector<float>& observed,
                                         const OptimizeTextureParams& params, std::vector<Exposure> start);

// Observed greys in the exposures of their frames.
std::vector<float> exposed(const Observations& observations, const std::vector<float>& observed,
                           const std::vector<Exposure>& exposure);

} // namespace quoin
