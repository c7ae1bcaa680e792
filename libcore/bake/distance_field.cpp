#include "bake/distance_field.h"

#include <algorithm>
#include <numbers>
#include <vector>

namespace quoin {

namespace {

// The least of every pixel and the row's others plus the distance to them, by ever longer steps: unlike a sweep from
// pixel to pixel it works on many pixels at a time. `other` is scratch of the row's size.
void relax_along(float* row, float* other, int width)
{
    for (int step = 1; step < width; step *= 2) {
        const auto distance = static_cast<float>(step);
        std::copy_n(row, width, other);
        for (int x = step; x < width; ++x)
            row[x] = std::min(row[x], other[x - step] + distance);
        for (int x = 0; x < width - step; ++x)
            row[x] = std::min(row[x], other[x + step] + distance);
    }
}

// From the row before, which has a pixel more at both ends.
void relax_across(float* row, const float* before, int width)
{
    constexpr float kDiagonal = std::numbers::sqrt2_v<float>;
    for (int x = 0; x < width; ++x)
        row[x] = std::min({row[x], before[x + 1] + 1.0f, std::min(before[x], before[x + 2]) + kDiagonal});
}

} // namespace

Image<float> grow_distances(Image<float> distance, float outside)
{
    const int width = distance.width, height = distance.height;
    const auto row_size = static_cast<std::size_t>(width) + 2;
    std::vector<float> before(row_size), scratch(row_size);
    const auto sweep = [&](int first, int step) {
        std::ranges::fill(before, outside);
        for (int y = first; y >= 0 && y < height; y += step) {
            float* row = distance.row(y);
            relax_across(row, before.data(), width);
            row[0] = std::min(row[0], outside + 1.0f);
            row[width - 1] = std::min(row[width - 1], outside + 1.0f);
            relax_along(row, scratch.data(), width);
            std::copy_n(row, width, before.data() + 1);
        }
    };
    sweep(0, 1);
    sweep(height - 1, -1);
    return distance;
}

} // namespace quoin
