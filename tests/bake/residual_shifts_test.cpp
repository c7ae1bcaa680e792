#include "bake/residual_shifts.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

namespace quoin {
namespace {

using Eigen::Vector2f;

constexpr int kStride = 2;
constexpr double kLimit = 2.0; // [texel]

using Pattern = std::function<float(float x, float y)>; // of texels

// 4 x 4 tiles, what is right of `end` unknown.
LumaLattice lattice_of(const Pattern& pattern, int end = 4 * kTileSize)
{
    LumaLattice result(4 * kTileSize / kStride, 4 * kTileSize / kStride, 0);
    for (int y = 0; y < result.height; ++y)
        for (int x = 0; x * kStride < end && x < result.width; ++x)
            result.at(x, y) = static_cast<std::uint8_t>(
                std::lround(pattern(static_cast<float>(x * kStride), static_cast<float>(y * kStride))));
    return result;
}

float waves(float x, float y) { return 120.0f + 50.0f * std::sin(0.4f * x) + 50.0f * std::sin(0.4f * y); }
float stripes(float x, float /*y*/) { return 120.0f + 50.0f * std::sin(0.4f * x); }

// What shows at a place that lies `shift` farther.
Pattern moved(const Pattern& pattern, const Vector2f& shift, float brighter = 0.0f)
{
    return [=](float x, float y) { return pattern(x - shift.x(), y - shift.y()) + brighter; };
}

Vector2f shift_at(const ResidualShifts& shifts, int x, int y)
{
    return shifts.shifted({{x, y}}, {x / kTileSize, y / kTileSize}).shift;
}

TEST(ResidualShifts, FindHowFarAViewIsOff)
{
    const Vector2f off(0.7f, -0.4f);
    const ResidualShifts shifts(lattice_of(moved(waves, off, 12.0f)), lattice_of(waves), kStride, kLimit);
    for (const int at : {20, 32, 41})
        EXPECT_LT((shift_at(shifts, at, 30) - off).norm(), 0.1f) << at;
}

TEST(ResidualShifts, StayNearZeroAlongStripes)
{
    const ResidualShifts shifts(lattice_of(moved(stripes, {0.7f, -0.4f})), lattice_of(stripes), kStride, kLimit);
    EXPECT_NEAR(shift_at(shifts, 32, 32).x(), 0.7f, 0.1f);
    EXPECT_NEAR(shift_at(shifts, 32, 32).y(), 0.0f, 1e-3f);
}

TEST(ResidualShifts, AreZeroWithoutDetailAndWhereNothingIsKnown)
{
    const Pattern ramp = [](float x, float y) { return 60.0f + x + y; };
    const ResidualShifts of_ramp(lattice_of(moved(ramp, {0.7f, 0.4f})), lattice_of(ramp), kStride, kLimit);
    EXPECT_LT(shift_at(of_ramp, 32, 32).norm(), 0.05f);
    const ResidualShifts of_half(lattice_of(moved(waves, {0.7f, 0.4f}), kTileSize), lattice_of(waves), kStride, kLimit);
    EXPECT_EQ(shift_at(of_half, 56, 32), Vector2f(0, 0));
    EXPECT_EQ(shift_at(ResidualShifts(), 32, 32), Vector2f(0, 0));
}

TEST(ResidualShifts, AreNeverLongerThanTheirLimit)
{
    const ResidualShifts shifts(lattice_of(moved(waves, {0.7f, 0.4f})), lattice_of(waves), kStride, 0.25);
    EXPECT_NEAR(shift_at(shifts, 32, 32).norm(), 0.25f, 1e-3f);
}

// A row ends where the next tile's begins.
TEST(ResidualShifts, AreContinuousAcrossTiles)
{
    const Pattern bent = [](float x, float y) { return waves(x - 0.02f * x, y); };
    const ResidualShifts shifts(lattice_of(bent), lattice_of(waves), kStride, kLimit);
    const TexelRow left = shifts.shifted({{kTileSize, 20}}, {1, 1}),
                   right = shifts.shifted({{2 * kTileSize, 20}}, {2, 1});
    EXPECT_GT(right.shift.x() - left.shift.x(), 0.05f);
    EXPECT_LT((left.shift + (kTileSize - 0.5f) * left.shift_step + 0.5f * right.shift_step - right.shift).norm(),
              1e-4f);
}

} // namespace
} // namespace quoin
