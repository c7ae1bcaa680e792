// Where depth jumps: the colours there mix two surfaces, and the depth may be of either.
#pragma once

#include "image/bit_mask.h"
#include "image/image.h"

namespace quoin {

// The least step between neighbouring depths that is an edge, by the nearer one: max(least, floor + square z^2) [m].
struct DepthJump {
    double least = 0.0, floor = 0.0, square = 0.0;
};

// Pixels at most `radius` columns and rows from one beside an edge. Missing depth is no edge.
BitMask near_depth_edges(const DepthImage& depth, int radius, const DepthJump& jump);

} // namespace quoin
