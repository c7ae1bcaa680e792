#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace quoin {

// Rows of pixels, top row first; pixel centres at integers.
template <class Pixel>
struct Image {
    int width = 0;
    int height = 0;
    std::vector<Pixel> pixels; // width * height

    Image() = default;
    Image(int w, int h, Pixel fill = {})
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill)
    {
    }
    bool empty() const { return pixels.empty(); }
    bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
    Pixel& at(int x, int y)
    {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    const Pixel& at(int x, int y) const
    {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    const Pixel* row(int y) const
    {
        return pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    }
    Pixel* row(int y) { return pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
};

using Rgb8 = std::array<std::uint8_t, 3>; // sRGB
using ColorImage = Image<Rgb8>;
using GrayImage = Image<float>;  // 0..1, sRGB luma
using DepthImage = Image<float>; // z [m]; 0 = missing

} // namespace quoin
