#include "synth/camera_path.h"
#include "synth/sensor.h"

#include <gmock/gmock.h>
#include <numbers>

namespace quoin {
namespace {

constexpr int kWidth = 160, kHeight = 120;

SynthParams without_errors()
{
    SynthParams p;
    p.depth_noise = p.depth_step = p.edge_holes = p.grazing_limit = p.min_depth = p.max_depth = 0.0;
    p.exposure_drift = p.white_balance_drift = p.black_level_drift = p.vignetting = p.image_noise = 0.0;
    p.blurred_frames = p.pose_drift = p.pose_drift_angle = p.color_offset = 0.0;
    return p;
}

ExactDepth wall_at(float z) { return {DepthImage(kWidth, kHeight, z), GrayImage(kWidth, kHeight, 1.0f)}; }

double deviation(const Image<std::uint16_t>& depth, double mean_mm)
{
    double sum = 0.0;
    for (const std::uint16_t d : depth.pixels)
        sum += (d - mean_mm) * (d - mean_mm);
    return std::sqrt(sum / static_cast<double>(depth.pixels.size()));
}

std::size_t missing(const Image<std::uint16_t>& depth)
{
    return static_cast<std::size_t>(std::count(depth.pixels.begin(), depth.pixels.end(), 0));
}

TEST(SenseDepth, IsExactToTheMillimetreWithoutErrors)
{
    for (const std::uint16_t d : sense_depth(wall_at(2.5f), without_errors(), 0).pixels)
        ASSERT_EQ(d, 2500);
}

TEST(SenseDepth, NoiseGrowsWithTheSquareOfDepth)
{
    SynthParams params = without_errors();
    params.depth_noise = 0.003;
    EXPECT_NEAR(deviation(sense_depth(wall_at(1.0f), params, 0), 1000.0), 3.0, 0.1);
    EXPECT_NEAR(deviation(sense_depth(wall_at(3.0f), params, 0), 3000.0), 27.0, 0.6);
}

TEST(SenseDepth, QuantisesInStepsThatGrowWithTheSquareOfDepth)
{
    SynthParams params = without_errors();
    params.depth_noise = 0.01;
    params.depth_step = 0.01;
    for (const std::uint16_t d : sense_depth(wall_at(1.0f), params, 0).pixels)
        ASSERT_EQ(d % 10, 0);
}

TEST(SenseDepth, LosesWhatIsTooFlatTooNearOrTooFar)
{
    SynthParams params = without_errors();
    params.grazing_limit = 80.0;
    ExactDepth flat = wall_at(1.0f);
    std::fill(flat.cosine.pixels.begin(), flat.cosine.pixels.end(),
              static_cast<float>(std::cos(85.0 * std::numbers::pi / 180.0)));
    EXPECT_EQ(missing(sense_depth(flat, params, 0)), flat.depth.pixels.size());
    params.min_depth = 0.5;
    params.max_depth = 4.0;
    EXPECT_EQ(missing(sense_depth(wall_at(0.4f), params, 0)), flat.depth.pixels.size());
    EXPECT_EQ(missing(sense_depth(wall_at(4.1f), params, 0)), flat.depth.pixels.size());
    EXPECT_EQ(missing(sense_depth(wall_at(2.0f), params, 0)), 0u);
}

TEST(SenseDepth, HasHolesBesideAJumpOnly)
{
    SynthParams params = without_errors();
    params.edge_holes = 2.0;
    ExactDepth step = wall_at(2.0f);
    for (int y = 0; y < kHeight; ++y)
        for (int x = kWidth / 2; x < kWidth; ++x)
            step.depth.at(x, y) = 3.0f;
    const Image<std::uint16_t> sensed = sense_depth(step, params, 0);
    EXPECT_GT(missing(sensed), static_cast<std::size_t>(2 * kHeight));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            if (std::abs(x + 0.5 - kWidth / 2) > 2.0) {
                ASSERT_NE(sensed.at(x, y), 0);
            }
        }
}

TEST(Expose, KeepsColoursWithoutErrorsAndAppliesGainAndBias)
{
    const ColorField grey(kWidth, kHeight, Eigen::Vector3f(100, 120, 140));
    for (const Rgb8& p : expose(grey, {}, without_errors(), 0).pixels)
        ASSERT_EQ(p, (Rgb8{100, 120, 140}));
    const TrueExposure bright{{1.5, 1.0, 0.5}, {4.0, 0.0, -4.0}};
    for (const Rgb8& p : expose(grey, bright, without_errors(), 0).pixels)
        ASSERT_EQ(p, (Rgb8{154, 120, 66}));
}

TEST(DrawFrameErrors, VanishWhenTheirParametersAreZero)
{
    for (const FrameErrors& e : draw_frame_errors(without_errors())) {
        EXPECT_TRUE(e.true_from_recorded.isApprox(Rigid::Identity(), 1e-12));
        EXPECT_TRUE(e.exposure.gain.isOnes() && e.exposure.bias.isZero() && e.spin.isZero());
    }
}

TEST(DrawFrameErrors, ReachTheirParametersAndNoMore)
{
    const SynthParams params;
    double place = 0.0, turn = 0.0, gain = 0.0;
    int blurred = 0;
    for (const FrameErrors& e : draw_frame_errors(params)) {
        place = std::max(place, e.true_from_recorded.translation().norm());
        turn = std::max(turn, rotation_angle(e.true_from_recorded.linear()));
        gain = std::max(gain, (e.exposure.gain.array() - 1.0).abs().maxCoeff());
        if (!e.spin.isZero()) ++blurred;
    }
    EXPECT_NEAR(place, params.pose_drift, 1e-6);
    EXPECT_NEAR(turn * 180.0 / std::numbers::pi, params.pose_drift_angle, 1e-6);
    EXPECT_GT(gain, 0.8 * params.exposure_drift);
    EXPECT_LT(gain, (1.0 + params.exposure_drift) * (1.0 + params.white_balance_drift) - 1.0);
    EXPECT_NEAR(blurred, params.blurred_frames * params.frames, 20);
}

TEST(HandHeldPath, StaysInTheRoomAndMovesSmoothly)
{
    const SynthParams params;
    const std::vector<Rigid> path = hand_held_path(params);
    ASSERT_EQ(path.size(), static_cast<std::size_t>(params.frames));
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Eigen::Vector3d p = path[i].translation();
        EXPECT_TRUE(is_rigid(path[i].matrix(), 1e-9));
        EXPECT_LT(std::abs(p.x()), 0.5 * params.room_width - 0.5);
        EXPECT_LT(std::abs(p.y()), 0.5 * params.room_length - 0.5);
        EXPECT_TRUE(p.z() > 0.5 && p.z() < params.room_height - 0.2);
        if (i > 0) {
            EXPECT_LT((p - path[i - 1].translation()).norm(), 0.35);
        }
    }
}

} // namespace
} // namespace quoin
