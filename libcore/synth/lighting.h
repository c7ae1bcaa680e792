#pragma once

#include "synth/rays.h"

#include <vector>

namespace quoin {

// Light that falls on a surface: a factor for its albedo, on a grid over its texture frame.
struct LightGrid {
    Eigen::Vector2d corner; // uv [m]
    Eigen::Vector2d cell;   // [m]
    int width = 0, height = 0;
    std::vector<float> value;
    std::vector<float> weight; // 0 for points inside other solids

    float at(const Eigen::Vector2d& uv) const;
};

// The grid of every surface; `low` and `high` are the corners of its texture [m].
struct TextureExtent {
    Eigen::Vector2d low, high;
};
LightGrid cast_light(const Room& room, const std::vector<Facet>& facets, const RayScene& rays, std::uint32_t surface,
                     const TextureExtent& extent);

} // namespace quoin
