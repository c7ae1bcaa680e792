#pragma once

#include "synth/room.h"
#include "synth/synthesize.h"

namespace quoin {

// The room of a seed: floor, ceiling and walls with the recesses of a door and a window, and furniture that stands
// where there is space. Deterministic in the parameters.
Room furnish_room(const SynthParams& params);

} // namespace quoin
