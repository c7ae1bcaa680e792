// The cells of a page that are taken, and where a shape still fits.
#pragma once

#include "image/bit_mask.h"

#include <vector>

namespace quoin {

// A mask, ready to be put somewhere.
class Shape {
public:
    explicit Shape(BitMask mask);

    struct Run {
        int row, first, length; // [cell]
    };
    const BitMask& mask() const { return mask_; }
    const std::vector<Run>& runs() const { return runs_; } // all cells of the mask, the longest runs first
    const BitMask& rim() const { return rim_; }            // the cells beside the mask; one wider than it on every side

private:
    BitMask mask_, rim_;
    std::vector<Run> runs_;
};

class Occupancy {
public:
    Occupancy(int width, int height);
    int width() const { return width_; }
    int height() const { return height_; }

    void take(const BitMask& mask, int x, int y);
    // Bit x of `fits`: the shape's cells are free when its corner is at (x, y). Returns whether any is. Requires
    // 0 <= y <= height - the mask's height.
    bool find_places(const Shape& shape, int y, std::vector<std::uint64_t>& fits) const;
    // How many cells of the shape's rim are taken or beyond the left, right or upper side of the page.
    int contact(const Shape& shape, int x, int y) const;

private:
    void update_row(int row);

    // Cell (x, y) of the page is bit (x + 1, y + 1): the bits around it count as taken.
    int width_, height_;
    std::vector<BitMask> reach_;   // reach_[k]: is any of the 2^k cells from here on to the right taken?
    std::vector<int> longest_gap_; // of every row of bits: free cells side by side
};

} // namespace quoin
