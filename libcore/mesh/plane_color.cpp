#include "mesh/plane_color.h"

#include <algorithm>
#include <cmath>

namespace quoin {

// Neighbouring ids get hues a golden angle apart, and three brightnesses in turn.
Rgb8 plane_color(PlaneId id)
{
    constexpr double kGoldenRatio = 0.6180339887498949;
    const double hue = 6.0 * std::fmod(kGoldenRatio * id, 1.0), value = 235.0 - 35.0 * (id % 3), saturation = 0.55;
    Rgb8 color{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double k = std::fmod(5.0 - 2.0 * static_cast<double>(c) + hue, 6.0);
        color[c] = static_cast<std::uint8_t>(
            std::lround(value * (1.0 - saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0))));
    }
    return color;
}

} // namespace quoin
