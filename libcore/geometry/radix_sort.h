// Sorting many items by an integer key.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace quoin {

struct Keyed {
    std::uint64_t key = 0;
    std::uint32_t item = 0;
};

// Sorts by key with a stable radix sort of 11-bit digits; digits that all keys share cost one pass of counting.
inline void radix_sort(std::vector<Keyed>& items)
{
    constexpr int kDigitBits = 11;
    constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
    std::vector<Keyed> buffer(items.size());
    std::vector<std::size_t> start(kDigits + 1);
    for (int shift = 0; shift < 64; shift += kDigitBits) {
        const auto digit = [&](const Keyed& item) { return (item.key >> shift) & (kDigits - 1); };
        std::fill(start.begin(), start.end(), 0);
        for (const auto& item : items)
            ++start[digit(item) + 1];
        if (std::find(start.begin(), start.end(), items.size()) != start.end()) continue;
        std::partial_sum(start.begin(), start.end(), start.begin());
        for (const auto& item : items)
            buffer[start[digit(item)]++] = item;
        items.swap(buffer);
    }
}

} // namespace quoin
