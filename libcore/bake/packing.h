// Rectangles onto pages: skyline, bottom left.
#pragma once

#include <cstdint>
#include <vector>

namespace quoin {

struct RectangleSize {
    int width = 0, height = 0; // [px]
};

struct PlacedRectangle {
    std::uint32_t page = 0;
    int x = 0, y = 0;    // of the top left pixel
    bool turned = false; // by a right angle: it covers height x width pixels
};

struct Packing {
    std::vector<PlacedRectangle> rectangle; // in the order of the sizes given
    std::vector<RectangleSize> page;
};

// Packs all rectangles without overlap, the longest sides first, each where its top is lowest (Jylänki 2010, skyline
// bottom-left), turned where that is better. The pages are as small as holds everything in one; when one page of
// max_page does not hold it, there are several. Page sides are multiples of 4. Requires every side <= max_page.
Packing pack_rectangles(const std::vector<RectangleSize>& sizes, int max_page);

} // namespace quoin
