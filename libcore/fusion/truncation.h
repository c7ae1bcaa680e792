// How far from a measured point a distance counts.
#pragma once

#include <algorithm>

namespace quoin {

// Depth sensors err with the square of the depth: a fixed truncation that suits near depths would make a surface of its
// own of every far measurement.
struct Truncation {
    float least = 0.0f;  // [m]
    float growth = 0.0f; // [1/m]

    float at(float depth) const { return std::max(least, growth * depth * depth); } // [m]
};

} // namespace quoin
