#include "bake/distance_field.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace quoin {
namespace {

// Along rows, columns and diagonals.
float way(int dx, int dy)
{
    const int longer = std::max(std::abs(dx), std::abs(dy)), shorter = std::min(std::abs(dx), std::abs(dy));
    return static_cast<float>(longer - shorter) + std::numbers::sqrt2_v<float> * static_cast<float>(shorter);
}

TEST(DistanceField, IsTheShortestWayToAnyStart)
{
    std::mt19937 random(3);
    constexpr float kFar = 1e6f, kOutside = 9.0f;
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(70, 1), std::pair(1, 9), std::pair(37, 23)}) {
        Image<float> start(width, height, kFar);
        for (auto& pixel : start.pixels)
            if (random() % 40 == 0) pixel = static_cast<float>(random() % 5);
        const auto grown = grow_distances(start, kOutside);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                float expected = kOutside + static_cast<float>(std::min({x + 1, y + 1, width - x, height - y}));
                for (int v = 0; v < height; ++v)
                    for (int u = 0; u < width; ++u)
                        expected = std::min(expected, start.at(u, v) + way(x - u, y - v));
                EXPECT_NEAR(grown.at(x, y), expected, 1e-4f) << x << ", " << y << " of " << width << " x " << height;
            }
    }
}

} // namespace
} // namespace quoin
