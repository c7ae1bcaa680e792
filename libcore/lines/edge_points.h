// Where the image has edges beside a line: maxima of its gradient across the line, point by point along it.
#pragma once

#include "image/image.h"
#include "lines/detect_lines.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

// Places at equal distances along a line of the image, each with a profile across it.
struct Strip {
    Eigen::Vector2d start, along, across; // of the first place [px]; unit vectors
    double step = 0.0;                    // between places [px]
    int places = 0;
};

// A maximum of the gradient along the profile of one place.
struct EdgePoint {
    int place;
    float offset;   // across the line [px]
    float gradient; // along `across`, of the smoothed image [grey levels of 255 a px]
};

// About guided_step px between places, one at each end.
Strip strip_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const DetectLinesParams& params);

// Edges of at least guided_gradient within guided_reach of the line, in the order of places and offsets. The line lies
// inside the image; profiles end at its borders.
std::vector<EdgePoint> edge_points(const GrayImage& image, const Strip& strip, const DetectLinesParams& params);

} // namespace quoin
