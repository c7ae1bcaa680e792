// Straight segments of an image, by OpenCV's detectors.
#pragma once

#include "image/image.h"
#include "lines/detect_lines.h"

#include <vector>

namespace quoin {

struct Segment {
    Eigen::Vector2d a, b; // [px]; pixel centres at integers
    double length() const { return (b - a).norm(); }
};

// Segments of at least the length that `params` ask for in an image of that width, in the detector's order.
std::vector<Segment> detect_segments(const GrayImage& image, const DetectLinesParams& params);

} // namespace quoin
