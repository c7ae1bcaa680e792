#include "bake/bit_mask.h"

#include <bit>

namespace quoin {

BitMask turned(const BitMask& mask)
{
    BitMask result(mask.height(), mask.width());
    for (int y = 0; y < mask.height(); ++y)
        for (int w = 0; w < mask.words(); ++w)
            for (std::uint64_t left = mask.row(y)[w]; left != 0; left &= left - 1)
                result.set(mask.height() - 1 - y, w * BitMask::kWordBits + std::countr_zero(left));
    return result;
}

std::size_t count(const BitMask& mask)
{
    std::size_t result = 0;
    for (int y = 0; y < mask.height(); ++y)
        for (int w = 0; w < mask.words(); ++w)
            result += static_cast<std::size_t>(std::popcount(mask.row(y)[w]));
    return result;
}

} // namespace quoin
