#include "alignment/depth_edges.h"

#include "base/lanes.h"

#include <algorithm>

namespace quoin {
namespace {

struct JumpLanes {
    float least, floor, square;

    // Of the first eight of `count` pixels and their neighbours.
    std::uint64_t edges(const float* here, const float* there, std::size_t count) const
    {
        const Floats a = load_part(here, count), b = load_part(there, count);
        const Floats nearer = a < b ? a : b, step = a < b ? b - a : a - b;
        return bits((nearer > 0.0f) & (step > floor + square * nearer * nearer) & (step > least));
    }
};

// Both pixels beside every edge.
BitMask beside_edges(const DepthImage& depth, const JumpLanes& jump)
{
    BitMask mask(depth.width, depth.height);
    const auto width = static_cast<std::size_t>(depth.width);
    const auto place = [](std::uint64_t* row, std::size_t x, std::uint64_t set) {
        row[x / BitMask::kWordBits] |= set << (x % BitMask::kWordBits);
    };
    for (int y = 0; y < depth.height; ++y)
        for (std::size_t x = 0; x < width; x += kFloats) {
            const float* here = depth.row(y) + x;
            const std::uint64_t to_right = jump.edges(here, here + 1, width - x - 1);
            const std::uint64_t down = y + 1 < depth.height ? jump.edges(here, here + width, width - x) : 0;
            place(mask.row(y), x, to_right | down);
            if (to_right != 0) place(mask.row(y), x + 1, to_right);
            if (down != 0) place(mask.row(y + 1), x, down);
            // The last of eight bits may belong to the next word.
            if (to_right >> (kFloats - 1) != 0 && (x + kFloats) % BitMask::kWordBits == 0)
                mask.set(static_cast<int>(x + kFloats), y);
        }
    return mask;
}

void widen_row(std::uint64_t* row, int words)
{
    std::uint64_t before = 0;
    for (int w = 0; w < words; ++w) {
        const std::uint64_t here = row[w], after = w + 1 < words ? row[w + 1] : 0;
        row[w] = here | here << 1 | here >> 1 | before >> (BitMask::kWordBits - 1) | after << (BitMask::kWordBits - 1);
        before = here;
    }
}

// Sets all within `radius` of what is set, in a square window: rows, then columns.
BitMask widened(BitMask mask, int radius)
{
    for (int y = 0; y < mask.height(); ++y) {
        std::uint64_t* row = mask.row(y);
        for (int i = 0; i < radius; ++i) {
            widen_row(row, mask.words());
            row[mask.width() / BitMask::kWordBits] &= (std::uint64_t{1} << (mask.width() % BitMask::kWordBits)) - 1;
            row[mask.words() - 1] = 0;
        }
    }
    BitMask result = mask;
    for (int y = 0; y < mask.height(); ++y)
        for (int v = std::max(0, y - radius); v <= std::min(mask.height() - 1, y + radius); ++v)
            for (int w = 0; w < mask.words(); ++w)
                result.row(y)[w] |= mask.row(v)[w];
    return result;
}

} // namespace

BitMask near_depth_edges(const DepthImage& depth, int radius, const DepthJump& jump)
{
    const JumpLanes lanes{static_cast<float>(jump.least), static_cast<float>(jump.floor),
                          static_cast<float>(jump.square)};
    return widened(beside_edges(depth, lanes), radius);
}

} // namespace quoin
