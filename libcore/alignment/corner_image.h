// A grey image that is sampled in very many places: every pixel stands in one word with the one below it, so that two
// words side by side are all four corners of a bilinear sample.
#pragma once

#include "base/lanes.h"
#include "image/image.h"

#include <array>
#include <vector>

namespace quoin {

// Greys from 0 on, in steps of a 65535th of the largest.
class CornerImage {
public:
    CornerImage() = default;
    CornerImage(const GrayImage& gray); // NOLINT(google-explicit-constructor): the same picture

    int width() const { return width_; }
    int height() const { return height_; }
    GrayImage gray() const;

    // Where (u, v) lies, 0 <= u < width - 1 and 0 <= v < height - 1: its upper left corner, by rows, and the parts of
    // the way to the next ones.
    struct Place {
        Ints offset;
        Floats along, down;
    };
    Place place(const Floats& u, const Floats& v) const
    {
        const Ints x = to_ints(u), y = to_ints(v);
        return {y * width_ + x, u - to_floats(x), v - to_floats(y)};
    }
    // Brings near what sample() will read there.
    void prefetch(const Place& place) const
    {
        std::array<int, kFloats> offset;
        store(place.offset, offset.data());
        for (const int at : offset)
            __builtin_prefetch(words_.data() + at);
    }
    // The bilinear surface and its exact derivative [1/px].
    struct Samples {
        Floats value, by_u, by_v;
    };
    Samples sample(const Place& place) const
    {
        const IntPairs word = gather_pairs(words_.data(), place.offset);
        const Floats left = upper(word.first), right = upper(word.second);
        const Floats lower_left = lower(word.first), lower_right = lower(word.second);
        const Floats slope_upper = right - left, slope_lower = lower_right - lower_left;
        const Floats upper_row = left + place.along * slope_upper, lower_row = lower_left + place.along * slope_lower;
        const Floats fall = lower_row - upper_row;
        return {step_ * (upper_row + place.down * fall),
                step_ * (slope_upper + place.down * (slope_lower - slope_upper)), step_ * fall};
    }

private:
    using Unsigned = unsigned __attribute__((vector_size(32)));
    static Floats upper(const Ints& word) { return to_floats(word & 0xffff); }
    static Floats lower(const Ints& word)
    {
        return to_floats(reinterpret_cast<Ints>(reinterpret_cast<Unsigned>(word) >> 16));
    }

    int width_ = 0, height_ = 0;
    float step_ = 1.0f;
    std::vector<std::uint32_t> words_;
};

} // namespace quoin
