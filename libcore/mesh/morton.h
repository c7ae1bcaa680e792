#pragma once

#include <cstdint>

namespace quoin {

// Spreads the low 21 bits of v so that two zeros follow each.
inline std::uint64_t spread_bits(std::uint64_t v)
{
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffff;
    v = (v | v << 16) & 0x1f0000ff0000ff;
    v = (v | v << 8) & 0x100f00f00f00f00f;
    v = (v | v << 4) & 0x10c30c30c30c30c3;
    return (v | v << 2) & 0x1249249249249249;
}

// Position along the Z-order curve of a cell with 21-bit coordinates; x changes fastest.
inline std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z)
{
    return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

} // namespace quoin
