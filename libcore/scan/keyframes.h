#pragma once

#include "scan/scan.h"

#include <vector>

namespace quoin {

// Why a frame is not a keyframe.
enum class Dropped : std::uint8_t {
    Kept = 0,
    NotSharpest = 1,
    TooClose = 2,
    Blurred = 3,
    InvalidPose = 4,
    HeldOut = 5,
    NoImage = 6,
    OverLimit = 7
};

struct Keyframes {
    std::vector<FrameId> frame;  // K, ascending
    std::vector<float> blur;     // N, 0 sharp .. 1 blurred (Crete et al. 2007); NaN where not measured
    std::vector<Dropped> reason; // N
};

} // namespace quoin
