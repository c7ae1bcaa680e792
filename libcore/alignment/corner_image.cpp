#include "alignment/corner_image.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr float kMostSteps = 65535.0f;

std::uint32_t steps(float gray)
{
    const float value = gray / CornerImage::kStep + 0.5f;
    return static_cast<std::uint32_t>(static_cast<int>(value > 0.0f ? (value < kMostSteps ? value : kMostSteps) : 0.0f));
}

} // namespace

CornerImage::CornerImage(const GrayImage& gray)
    : width_(gray.width), height_(gray.height), words_(gray.pixels.size())
{
    for (int y = 0; y < height_; ++y) {
        const float *upper = gray.row(y), *lower = gray.row(std::min(y + 1, height_ - 1));
        std::uint32_t* word = words_.data() + (upper - gray.pixels.data());
        for (int x = 0; x < width_; ++x)
            word[x] = steps(upper[x]) | steps(lower[x]) << 16;
    }
}

GrayImage CornerImage::gray() const
{
    GrayImage result(width_, height_);
    std::ranges::transform(words_, result.pixels.begin(),
                           [](std::uint32_t word) { return static_cast<float>(static_cast<int>(word & 0xffffu)) * kStep; });
    return result;
}

} // namespace quoin
