// The loss of light towards the corners, so that it is not taken for exposure or for texture.
#pragma once

#include "alignment/observations.h"
#include "scan/vignetting.h"

#include <span>

namespace quoin {

// (distance to the middle of the image / that of its corners)^2 of every observation's pixel.
std::vector<float> squared_radii(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                 const Observations& observations);

// The vignetting under which all frames see the same texel colours, in turns with their exposures: a robust linear
// system with the colours eliminated and a prior to none. `channels`: observed colours, 0..1, of every observation.
// `start`: exposures to begin with.
// None where a texel is not seen at different radii, or where what is found is no lens: a gain, or a loss of three
// quarters.
Vignetting estimate_vignetting(const Observations& observations, const std::vector<float>& squared_radius,
                               std::span<const std::vector<float>> channels, const std::vector<Exposure>& start,
                               const OptimizeTextureParams& params);

// Takes it out of the grey images of all levels.
void correct(AlignmentScene& scene, const Vignetting& vignetting);
// And out of the observations of a channel.
std::vector<float> corrected(const std::vector<float>& observed, const std::vector<float>& squared_radius,
                             const Vignetting& vignetting);

} // namespace quoin
