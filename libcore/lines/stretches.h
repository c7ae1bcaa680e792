// The parts of straight borders that a camera sees, and how a segment of its image lies to them.
#pragma once

#include "lines/segments.h"
#include "lines/straight_borders.h"
#include "render/rasterize.h"

#include <array>
#include <optional>
#include <vector>

namespace quoin {

// A mesh as a camera sees it.
struct MeshView {
    Camera camera;
    Rigid camera_from_world;
    Visibility visibility; // rendered by this camera
    const PlaneMesh* mesh = nullptr;
};

// Ends of a visible stretch of a border, in camera coordinates [m] and in the image [px].
struct Stretch {
    std::size_t border;
    std::array<Eigen::Vector3d, 2> p_camera;
    std::array<Eigen::Vector2d, 2> pixel;
};

// In the order of the borders, and along each from its first end.
std::vector<Stretch> visible_stretches(const std::vector<StraightBorder>& borders, const MeshView& view,
                                       const DetectLinesParams& params);

// The part of a stretch beside a segment.
struct Overlap {
    std::array<Eigen::Vector3d, 2> p_camera; // ends on the border [m], in the order of the segment's
    double distance;                         // mean distance of its image to the segment's line [px]
};

// Nothing where the two are farther apart, differ more in direction or overlap less than `params` allow.
std::optional<Overlap> overlap_of(const Segment& segment, const Stretch& stretch, const Camera& camera,
                                  const DetectLinesParams& params);

} // namespace quoin
