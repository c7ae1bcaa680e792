// Segments found where borders are expected: no detector looks at the rest of the image.
#pragma once

#include "image/image.h"
#include "lines/match_segments.h"

#include <vector>

namespace quoin {

// For each stretch the straight edge beside it that most of its places see with one polarity, and nearest among equals;
// at least min_segment long. In the order of the stretches; an edge beside several belongs to the nearest.
std::vector<SegmentMatch> follow_stretches(const GrayImage& image, const std::vector<Stretch>& stretches,
                                           const MeshView& view, const DetectLinesParams& params);

} // namespace quoin
