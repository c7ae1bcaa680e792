#include "alignment/corner_image.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr float kHalfWord = 65535.0f; // that half a word counts

}

CornerImage::CornerImage(const GrayImage& gray) : width_(gray.width), height_(gray.height), words_(gray.pixels.size())
{
    float largest = 0.0f;
    for (const float value : gray.pixels)
        largest = value > largest ? value : largest;
    if (largest > 0.0f) step_ = largest / kHalfWord;
    const float steps = largest > 0.0f ? kHalfWord / largest : 1.0f;
    const auto counted = [&](float value) {
        return static_cast<std::uint32_t>(static_cast<int>(value > 0.0f ? value * steps + 0.5f : 0.0f));
    };
    for (int y = 0; y < height_; ++y) {
        const float *upper = gray.row(y), *lower = gray.row(std::min(y + 1, height_ - 1));
        std::uint32_t* word = words_.data() + (upper - gray.pixels.data());
        for (int x = 0; x < width_; ++x)
            word[x] = counted(upper[x]) | counted(lower[x]) << 16;
    }
}

GrayImage CornerImage::gray() const
{
    GrayImage result(width_, height_);
    std::ranges::transform(words_, result.pixels.begin(), [&](std::uint32_t word) {
        return static_cast<float>(static_cast<int>(word & 0xffffu)) * step_;
    });
    return result;
}

} // namespace quoin
