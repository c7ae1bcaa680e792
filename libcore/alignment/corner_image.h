// A grey image that is sampled in very many places: every pixel stands in one word with the one below it, so that two
// words side by side are all four corners of a bilinear sample.
#pragma once

#include "base/lanes.h"
#include "image/image.h"

namespace quoin {

// Greys in steps of 2^-14, a 64th of what a camera tells apart, from 0 to nearly 4: a correction may brighten.
class CornerImage {
public:
    static constexpr float kStep = 1.0f / 16384.0f;

    CornerImage() = default;
    CornerImage(const GrayImage& gray); // NOLINT(google-explicit-constructor): the same picture

    int width() const { return width_; }
    int height() const { return height_; }
    GrayImage gray() const;

    // At (u, v), 0 <= u < width - 1 and 0 <= v < height - 1: the bilinear surface and its exact derivative [1/px].
    struct Samples {
        Floats value, by_u, by_v;
    };
    Samples sample(const Floats& u, const Floats& v) const
    {
        const Ints x = to_ints(u), y = to_ints(v);
        const Floats along = u - to_floats(x), down = v - to_floats(y);
        const IntPairs word = gather_pairs(words_.data(), y * width_ + x);
        const Floats left = upper(word.first), right = upper(word.second);
        const Floats lower_left = lower(word.first), lower_right = lower(word.second);
        const Floats slope_upper = right - left, slope_lower = lower_right - lower_left;
        const Floats upper_row = left + along * slope_upper, lower_row = lower_left + along * slope_lower;
        const Floats fall = lower_row - upper_row;
        return {kStep * (upper_row + down * fall), kStep * (slope_upper + down * (slope_lower - slope_upper)),
                kStep * fall};
    }

private:
    using Unsigned = unsigned __attribute__((vector_size(32)));
    static Floats upper(const Ints& word) { return to_floats(word & 0xffff); }
    static Floats lower(const Ints& word)
    {
        return to_floats(reinterpret_cast<Ints>(reinterpret_cast<Unsigned>(word) >> 16));
    }

    int width_ = 0, height_ = 0;
    std::vector<std::uint32_t> words_;
};

} // namespace quoin
