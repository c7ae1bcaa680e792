// Eight floats or four doubles that one instruction works on. Sums run in lanes, which are added up in order: the same
// bytes on every machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace quoin {

using Floats = float __attribute__((vector_size(32)));
using Ints = int __attribute__((vector_size(32)));
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

inline Ints load(const int* from)
{
    Ints lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}
inline void store(const Ints& lanes, int* to) { std::memcpy(to, &lanes, sizeof lanes); }

inline Floats each(float value) { return Floats{} + value; }
inline Floats size_of(const Floats& value) { return value < 0.0f ? -value : value; }
inline Floats to_floats(const Ints& lanes) { return __builtin_convertvector(lanes, Floats); }
inline Ints to_ints(const Floats& lanes) { return __builtin_convertvector(lanes, Ints); } // towards 0

// The first `count` lanes, zero in the others: for the end of an array, of which no more is touched.
#ifdef __AVX2__
inline __m256i first_lanes(std::size_t count)
{
    alignas(32) static constexpr int kMask[2 * kFloats] = {-1, -1, -1, -1, -1, -1, -1, -1};
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kMask + kFloats - std::min(count, kFloats)));
}
inline Floats load_part(const float* from, std::size_t count) { return _mm256_maskload_ps(from, first_lanes(count)); }
inline Ints load_part(const std::uint32_t* from, std::size_t count)
{
    return reinterpret_cast<Ints>(_mm256_maskload_epi32(reinterpret_cast<const int*>(from), first_lanes(count)));
}
inline void store_part(const Floats& lanes, float* to, std::size_t count)
{
    if (count >= kFloats)
        store(lanes, to);
    else
        _mm256_maskstore_ps(to, first_lanes(count), lanes);
}
inline Doubles load_doubles(const float* from, std::size_t count)
{
    return _mm256_cvtps_pd(_mm_maskload_ps(from, _mm256_castsi256_si128(first_lanes(count))));
}
#else
inline Doubles load_doubles(const float* from, std::size_t count)
{
    Doubles lanes{};
    for (std::size_t i = 0; i < std::min(count, kDoubles); ++i)
        lanes[i] = from[i];
    return lanes;
}
inline Floats load_part(const float* from, std::size_t count)
{
    Floats lanes{};
    std::memcpy(&lanes, from, std::min(count, kFloats) * sizeof(float));
    return lanes;
}
inline Ints load_part(const std::uint32_t* from, std::size_t count)
{
    Ints lanes{};
    std::memcpy(&lanes, from, std::min(count, kFloats) * sizeof(int));
    return lanes;
}
inline void store_part(const Floats& lanes, float* to, std::size_t count)
{
    std::memcpy(to, &lanes, std::min(count, kFloats) * sizeof(float));
}
#endif

// from[index] of every lane.
inline Floats gather(const float* from, const Ints& index)
{
#ifdef __AVX2__
    return _mm256_i32gather_ps(from, reinterpret_cast<__m256i>(index), sizeof(float));
#else
    Floats lanes;
    for (std::size_t i = 0; i < kFloats; ++i)
        lanes[i] = from[index[i]];
    return lanes;
#endif
}
inline Ints gather(const std::uint32_t* from, const Ints& index)
{
#ifdef __AVX2__
    const auto* ints = reinterpret_cast<const int*>(from);
    return reinterpret_cast<Ints>(_mm256_i32gather_epi32(ints, reinterpret_cast<__m256i>(index), sizeof(int)));
#else
    Ints lanes;
    for (std::size_t i = 0; i < kFloats; ++i)
        lanes[i] = static_cast<int>(from[index[i]]);
    return lanes;
#endif
}

// from[index] and from[index + 1] of every lane.
struct IntPairs {
    Ints first, second;
};
inline IntPairs gather_pairs(const std::uint32_t* from, const Ints& index)
{
#ifdef __AVX2__
    // Lanes 0, 1, 4, 5 and 2, 3, 6, 7, so that the halves of both come apart in order.
    const __m256i order = _mm256_permute4x64_epi64(reinterpret_cast<__m256i>(index), 0b11'01'10'00);
    const auto* pairs = reinterpret_cast<const long long*>(from);
    const auto a = reinterpret_cast<__m256>(_mm256_i32gather_epi64(pairs, _mm256_castsi256_si128(order), sizeof(int)));
    const auto b =
        reinterpret_cast<__m256>(_mm256_i32gather_epi64(pairs, _mm256_extracti128_si256(order, 1), sizeof(int)));
    return {reinterpret_cast<Ints>(_mm256_shuffle_ps(a, b, 0b10'00'10'00)),
            reinterpret_cast<Ints>(_mm256_shuffle_ps(a, b, 0b11'01'11'01))};
#else
    return {gather(from, index), gather(from + 1, index)};
#endif
}

// The first `count` lanes, zero in the others.
inline Floats first_of(const Floats& lanes, std::size_t count)
{
    constexpr Ints kLane{0, 1, 2, 3, 4, 5, 6, 7};
    return kLane < static_cast<int>(std::min(count, kFloats)) ? lanes : Floats{};
}

inline Floats square_root(const Floats& lanes)
{
#ifdef __AVX2__
    return _mm256_sqrt_ps(lanes);
#else
    Floats result;
    for (std::size_t i = 0; i < kFloats; ++i)
        result[i] = std::sqrt(lanes[i]);
    return result;
#endif
}

// Bit i is set where lane i of a comparison holds.
inline unsigned bits(const Ints& is_true)
{
#ifdef __AVX2__
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(is_true)));
#else
    unsigned result = 0;
    for (std::size_t i = 0; i < kFloats; ++i)
        result |= static_cast<unsigned>(is_true[i] != 0) << i;
    return result;
#endif
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
