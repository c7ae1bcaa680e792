// Counter-based random numbers: a draw depends on the key and its index alone, so any pixel of any frame can be
// computed first, last or twice (Salmon et al., Parallel random numbers: as easy as 1, 2, 3, 2011; the mixer is
// SplitMix64's).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace quoin {

inline std::uint64_t mix_bits(std::uint64_t x)
{
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

// What a sequence of draws is for; two purposes never share numbers.
enum class RandomPurpose : std::uint64_t { Layout = 1, Style, Light, Path, Drift, Exposure, Blur, Color, Depth, Truth };

class CounterRandom {
public:
    CounterRandom(std::uint64_t seed, RandomPurpose purpose, std::uint64_t frame = 0, std::uint64_t item = 0)
        : key_(mix_bits(mix_bits(mix_bits(seed) ^ static_cast<std::uint64_t>(purpose)) ^ (frame << 32 ^ item)))
    {
    }
    std::uint64_t bits() { return mix_bits(key_ + 0xd1342543de82ef95ull * ++count_); }
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; } // [0, 1)
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(uniform() * n); }
    double gaussian() // Box and Muller 1958
    {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return radius * std::cos(2.0 * std::numbers::pi * uniform());
    }

private:
    std::uint64_t key_;
    std::uint64_t count_ = 0;
};

} // namespace quoin
