#include "bake/distance_field.h"

#include <algorithm>
#include <numbers>

namespace quoin {

Image<float> grow_distances(Image<float> distance, float outside)
{
    constexpr float kDiagonal = std::numbers::sqrt2_v<float>;
    const auto beside = [&](int x, int y) { return distance.contains(x, y) ? distance.at(x, y) : outside; };
    const auto relax = [&](int x, int y, int side) {
        distance.at(x, y) = std::min({distance.at(x, y), beside(x + side, y) + 1.0f, beside(x, y + side) + 1.0f,
                                      beside(x + side, y + side) + kDiagonal, beside(x - side, y + side) + kDiagonal});
    };
    for (int y = 0; y < distance.height; ++y)
        for (int x = 0; x < distance.width; ++x)
            relax(x, y, -1);
    for (int y = distance.height - 1; y >= 0; --y)
        for (int x = distance.width - 1; x >= 0; --x)
            relax(x, y, 1);
    return distance;
}

} // namespace quoin
