// Eight floats or four doubles that one instruction works on. Sums run in lanes, which are added up in order: the same
// bytes on every machine.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace quoin {

using Floats = float __attribute__((vector_size(32)));
using Doubles = double __attribute__((vector_size(32)));
inline constexpr std::size_t kFloats = sizeof(Floats) / sizeof(float);
inline constexpr std::size_t kDoubles = sizeof(Doubles) / sizeof(double);

inline Floats load(const float* from)
{
    Floats lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}
inline Doubles load(const double* from)
{
    Doubles lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}
inline void store(const Floats& lanes, float* to) { std::memcpy(to, &lanes, sizeof lanes); }

// The first `count` lanes; zero in the others. For the end of an array.
inline Floats load_part(const float* from, std::size_t count)
{
    Floats lanes{};
    std::memcpy(&lanes, from, std::min(count, kFloats) * sizeof(float));
    return lanes;
}
inline void store_part(const Floats& lanes, float* to, std::size_t count)
{
    std::memcpy(to, &lanes, std::min(count, kFloats) * sizeof(float));
}

inline double sum(const Floats& lanes)
{
    double total = 0.0;
    for (std::size_t i = 0; i < kFloats; ++i)
        total += static_cast<double>(lanes[i]);
    return total;
}
inline double sum(const Doubles& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

} // namespace quoin
