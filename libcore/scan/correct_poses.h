// What the alignment of the keyframes says of all frames.
#pragma once

#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

namespace quoin {

// The scan with the poses and the colour camera of the alignment. Tracking errs little from frame to frame and drifts
// over many: frames between keyframes are moved and turned as the keyframes around them are, along a cubic through
// their corrections (Catmull-Rom); those before the first and behind the last as that one. Throws InputError when
// keyframes and alignment are not of one run or not of this scan.
Scan corrected_scan(Scan scan, const Keyframes& keyframes, const Alignment& alignment);

} // namespace quoin
