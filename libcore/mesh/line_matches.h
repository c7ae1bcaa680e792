#pragma once

#include "geometry/plane.h"
#include "scan/scan.h"

#include <Eigen/Core>
#include <array>
#include <vector>

namespace quoin {

// A straight segment in a keyframe's colour image, matched to the border between two planes.
struct LineMatch {
    Eigen::Vector4f segment;                     // x0 y0 x1 y1 [px], colour image
    FrameId frame = 0;                           // of the scan
    std::array<PlaneId, 2> planes{};             // the smaller id first
    std::array<Eigen::Vector3f, 2> end_points{}; // of the 3D border, world [m], in the order of the segment's ends
    float fit_error = 0.0f;                      // mean distance of the projected border to the segment [px]
};

using LineMatches = std::vector<LineMatch>;

} // namespace quoin
