// Which segment of an image shows which border between planes.
#pragma once

#include "lines/segments.h"
#include "lines/stretches.h"

#include <vector>

namespace quoin {

struct SegmentMatch {
    Segment segment;
    std::size_t border;
    std::array<Eigen::Vector3d, 2> ends; // of the overlap on the border, world [m], in the order of the segment's ends
    double distance;                     // mean distance of the projected overlap to the segment's line [px]
};

SegmentMatch matched(const Segment& segment, const Stretch& stretch, const Overlap& overlap, const MeshView& view);

// In the order of the segments. One match a segment at most; no two segments share a part of a stretch.
std::vector<SegmentMatch> match_segments(const std::vector<Segment>& segments, const std::vector<Stretch>& stretches,
                                         const MeshView& view, const DetectLinesParams& params);

} // namespace quoin
