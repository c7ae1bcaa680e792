#pragma once

#include "alignment/observations.h"
#include "scan/alignment.h"

namespace quoin {

struct ChannelSource {
    const AlignmentScene& scene;
    const Keyframes& keyframes;
    const ImageReader& read; // colours are read once more: keeping them all would take most of the memory
    const Texels& texels;
    const Observations& observations; // of the final poses and planes
};

// Sets the vignetting, and gain and bias of every keyframe and colour channel, at the final poses and planes.
void set_channel_exposures(Alignment& alignment, const ChannelSource& source, const AlignmentState& state);

} // namespace quoin
