#include "image/bit_mask.h"

namespace quoin {

BitMask turned(const BitMask& mask)
{
    BitMask result(mask.height(), mask.width());
    for_each(mask, [&](int x, int y) { result.set(mask.height() - 1 - y, x); });
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
