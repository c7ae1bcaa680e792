#include "bake/distance_field.h"

#include <algorithm>
#include <numbers>
#include <vector>

namespace quoin {

namespace {

// One pixel from its neighbours on one side: beside it and in the row before, whose ends are `outside`.
void relax(float& pixel, float beside, float before, float before_left, float before_right)
{
    constexpr float kDiagonal = std::numbers::sqrt2_v<float>;
    pixel = std::min({pixel, beside + 1.0f, before + 1.0f, std::min(before_left, before_right) + kDiagonal});
}

} // namespace

Image<float> grow_distances(Image<float> distance, float outside)
{
    const int last = distance.width - 1;
    const std::vector<float> border(static_cast<std::size_t>(distance.width), outside);
    for (int y = 0; y < distance.height; ++y) {
        float* row = distance.row(y);
        const float* before = y > 0 ? distance.row(y - 1) : border.data();
        for (int x = 0; x <= last; ++x)
            relax(row[x], x > 0 ? row[x - 1] : outside, before[x], x > 0 ? before[x - 1] : outside,
                  x < last ? before[x + 1] : outside);
    }
    for (int y = distance.height - 1; y >= 0; --y) {
        float* row = distance.row(y);
        const float* before = y + 1 < distance.height ? distance.row(y + 1) : border.data();
        for (int x = last; x >= 0; --x)
            relax(row[x], x < last ? row[x + 1] : outside, before[x], x > 0 ? before[x - 1] : outside,
                  x < last ? before[x + 1] : outside);
    }
    return distance;
}

} // namespace quoin
