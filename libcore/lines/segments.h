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

// What `params` ask for in an image of that width [px].
double min_segment_length(const GrayImage& image, const DetectLinesParams& params);

// Segments of at least that length, in the order of the detector that `params` name, lsd or edlines.
std::vector<Segment> detect_segments(const GrayImage& image, const DetectLinesParams& params);

} // namespace quoin
