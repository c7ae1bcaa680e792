#pragma once

#include <cstddef>
#include <vector>

namespace quoin {

inline constexpr int kReach = 3; // of a slope [px]: wide enough for the steps of a quantised sensor

// Depth with a margin of missing pixels, so that every pixel has all its neighbours.
class PaddedDepth {
public:
    PaddedDepth(int width, int height)
        : width_(width), height_(height), stride_(static_cast<std::size_t>(width + 2 * kReach)),
          z_(stride_ * static_cast<std::size_t>(height + 2 * kReach), 0.0f)
    {
    }
    int width() const { return width_; }
    int height() const { return height_; }
    float* row(int y) { return z_.data() + static_cast<std::size_t>(y + kReach) * stride_ + kReach; }
    const float* row(int y) const { return z_.data() + static_cast<std::size_t>(y + kReach) * stride_ + kReach; }

private:
    int width_, height_;
    std::size_t stride_;
    std::vector<float> z_; // [m]; 0 = missing
};

} // namespace quoin
