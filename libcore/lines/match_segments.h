// Which segment of an image shows which border between planes.
#pragma once

#include "lines/segments.h"
#include "lines/straight_borders.h"
#include "render/rasterize.h"

#include <vector>

namespace quoin {

struct View {
    Camera camera;
    Rigid camera_from_world;
    Visibility visibility; // of `mesh`, rendered by this camera
    const PlaneMesh* mesh = nullptr;
};

struct SegmentMatch {
    std::size_t segment;
    std::size_t border;
    std::array<Eigen::Vector3d, 2> ends; // of the overlap on the border, world [m], in the order of the segment's ends
    double distance;                     // mean distance of the projected overlap to the segment's line [px]
};

// In the order of the segments. One match a segment at most; no two segments share a stretch of a border.
std::vector<SegmentMatch> match_segments(const std::vector<Segment>& segments,
                                         const std::vector<StraightBorder>& borders, const View& view,
                                         const DetectLinesParams& params);

} // namespace quoin
