// What the decoders of the single formats give, and what is asked of them.
#pragma once

#include "image/formats.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace quoin::formats {

// How a picture is to be decoded.
struct Request {
    bool as_gray = false; // 8 bits of luma, whatever the file has
    int reduction = 1;    // 1, 2 or 4: at 1/reduction of the size
};

// Pixels in rows from the top, without gaps; channels side by side; values of 16 bits in this machine's order.
struct Raster {
    int width = 0;    // [px]
    int height = 0;   // [px]
    int channels = 0; // 1 grey, 3 RGB
    int bits = 0;     // a channel: 8 or 16
    std::vector<std::uint8_t> bytes;

    std::size_t row_bytes() const { return static_cast<std::size_t>(width * channels * (bits / 8)); }
    std::uint8_t* row(int y) { return bytes.data() + static_cast<std::size_t>(y) * row_bytes(); }

    // Makes room for the pixels.
    void allocate() { bytes.resize(static_cast<std::size_t>(height) * row_bytes()); }
};

} // namespace quoin::formats
