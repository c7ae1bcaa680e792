#pragma once

#include "mesh/ground_truth.h"
#include "synth/render_view.h"
#include "synth/synthesize.h"

#include <vector>

namespace quoin {

// All that ground_truth/ holds but the frames: mesh, planes, creases and surface samples; what counts as seen is what a
// depth camera at one of `views` measures, within range and not too flat.
GroundTruth survey_room(const PaintedRoom& room, const std::vector<View>& views, const SynthParams& params);

} // namespace quoin
