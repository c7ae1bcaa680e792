// Sets of cells, 64 of a row in a word.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace quoin {

class BitMask {
public:
    static constexpr int kWordBits = 64;

    BitMask() = default;
    BitMask(int width, int height)
        : width_(width), height_(height), words_(static_cast<std::size_t>(width / kWordBits + 2)),
          bits_(words_ * static_cast<std::size_t>(height), 0)
    {
    }

    int width() const { return width_; }
    int height() const { return height_; }
    // Every row ends with a word of zeros, so that `bits_from` may read past the width.
    int words() const { return static_cast<int>(words_); }
    std::uint64_t* row(int y) { return bits_.data() + static_cast<std::size_t>(y) * words_; }
    const std::uint64_t* row(int y) const { return bits_.data() + static_cast<std::size_t>(y) * words_; }

    bool test(int x, int y) const { return row(y)[x / kWordBits] >> (x % kWordBits) & 1; }
    void set(int x, int y) { row(y)[x / kWordBits] |= std::uint64_t{1} << (x % kWordBits); }

private:
    int width_ = 0, height_ = 0;
    std::size_t words_ = 0;
    std::vector<std::uint64_t> bits_;
};

// The 64 cells of a row from x on. Requires 0 <= x < the mask's width.
inline std::uint64_t bits_from(const std::uint64_t* row, int x)
{
    const std::uint64_t* word = row + x / BitMask::kWordBits;
    const int shift = x % BitMask::kWordBits;
    return shift == 0 ? word[0] : word[0] >> shift | word[1] << (BitMask::kWordBits - shift);
}

// Calls use(x, y) for every cell of the set, row by row.
template <class Use>
void for_each(const BitMask& mask, const Use& use)
{
    for (int y = 0; y < mask.height(); ++y)
        for (int w = 0; w < mask.words(); ++w)
            for (std::uint64_t left = mask.row(y)[w]; left != 0; left &= left - 1)
                use(w * BitMask::kWordBits + std::countr_zero(left), y);
}

// Turned clockwise by a right angle: the left column becomes the top row.
BitMask turned(const BitMask& mask);

std::size_t count(const BitMask& mask);

} // namespace quoin
