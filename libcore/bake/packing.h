// Shapes onto pages, cell by cell.
#pragma once

#include "image/bit_mask.h"

#include <cstdint>
#include <vector>

namespace quoin {

struct PageSize {
    int width = 0, height = 0;
};

struct PlacedMask {
    std::uint32_t page = 0;
    int x = 0, y = 0; // of its top left cell on the page
    int turns = 0;    // clockwise right angles, before it is placed
};

struct Packing {
    std::vector<PlacedMask> mask; // in the order of the masks given
    std::vector<PageSize> page;
};

// Of all pages together [px].
double area_of(const std::vector<PageSize>& pages);

// Packs all masks so that no two share a cell: the largest first, each as high up as it gets by any of its four turns,
// and near there where it touches the most of what is there already. So small ones fill the holes and bays of large
// ones. Some widths are tried and the fullest page taken. One page that is nearly square when max_side allows it, else
// several; all end below what they hold, and their sides are multiples of `multiple`. Requires masks with sides from 1
// to max_side, a multiple of `multiple`.
Packing pack_masks(const std::vector<BitMask>& masks, int max_side, int multiple);

} // namespace quoin
