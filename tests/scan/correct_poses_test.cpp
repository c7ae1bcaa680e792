#include "scan/correct_poses.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFrames = 41;

// A camera that walks and turns.
Rigid recorded(double i)
{
    Rigid world_from_camera = Rigid::Identity();
    world_from_camera.linear() = Eigen::AngleAxisd(0.05 * i, Vector3d::UnitY()).toRotationMatrix();
    world_from_camera.translation() = Vector3d(0.03 * i, 0.01 * i, -0.02 * i);
    return world_from_camera.inverse();
}

// Where it is: tracking drifts smoothly by up to 2 cm and half a degree.
Rigid truth(double i)
{
    const double phase = 2.0 * std::numbers::pi * i / 40.0;
    Rigid world_from_camera = recorded(i).inverse();
    world_from_camera.linear() =
        Eigen::AngleAxisd(0.009 * std::sin(phase), Vector3d(1, 2, 2) / 3.0).toRotationMatrix() *
        world_from_camera.linear();
    world_from_camera.translation() += 0.02 * Vector3d(std::sin(phase), std::cos(phase), 0.5 * std::sin(phase));
    return world_from_camera.inverse();
}

struct Tracked {
    Scan scan;
    Keyframes keyframes;
    Alignment alignment;
};

Tracked tracked(FrameId interval)
{
    Tracked result;
    for (std::size_t i = 0; i < kFrames; ++i)
        result.scan.frames.push_back({recorded(static_cast<double>(i)), FrameUse::Used, 0.0, {}, {}});
    for (FrameId id = 2; id < kFrames; id += interval) {
        result.keyframes.frame.push_back(id);
        result.alignment.camera_from_world.push_back(truth(id));
    }
    result.alignment.color = {640, 480, 500.0, 500.0, 320.0, 240.0};
    result.alignment.depth_from_color.translation() = Vector3d(0.02, 0, 0);
    return result;
}

double distance_between(const Rigid& a, const Rigid& b)
{
    return (a.inverse().translation() - b.inverse().translation()).norm();
}

TEST(CorrectedScan, HasThePosesOfTheKeyframesAndTheirCamera)
{
    const Tracked input = tracked(6);
    const Scan scan = corrected_scan(input.scan, input.keyframes, input.alignment);
    for (std::size_t k = 0; k < input.keyframes.frame.size(); ++k)
        EXPECT_TRUE(scan.frames[input.keyframes.frame[k]].camera_from_world.isApprox(
            input.alignment.camera_from_world[k], 1e-9));
    EXPECT_EQ(scan.color.fx, 500.0);
    EXPECT_TRUE(scan.depth_from_color.isApprox(input.alignment.depth_from_color));
}

TEST(CorrectedScan, FollowsASmoothDriftBetweenKeyframes)
{
    const Tracked input = tracked(6);
    const Scan scan = corrected_scan(input.scan, input.keyframes, input.alignment);
    for (FrameId id = input.keyframes.frame[1]; id < input.keyframes.frame[input.keyframes.frame.size() - 2]; ++id) {
        EXPECT_LT(distance_between(scan.frames[id].camera_from_world, truth(id)), 0.0005) << id;
        EXPECT_LT(rotation_angle(scan.frames[id].camera_from_world.linear() * truth(id).linear().transpose()), 0.0005);
    }
}

TEST(CorrectedScan, MovesFramesBeforeAndBehindAllKeyframesAsTheNearest)
{
    const Tracked input = tracked(6);
    const Scan scan = corrected_scan(input.scan, input.keyframes, input.alignment);
    const Vector3d shift = truth(2).inverse().translation() - recorded(2).inverse().translation();
    EXPECT_TRUE((scan.frames[0].camera_from_world.inverse().translation() - recorded(0).inverse().translation())
                    .isApprox(shift, 1e-9));
}

TEST(CorrectedScan, LeavesFramesWithoutAPoseAlone)
{
    Tracked input = tracked(6);
    input.scan.frames[4].use = FrameUse::Invalid;
    const Scan scan = corrected_scan(input.scan, input.keyframes, input.alignment);
    EXPECT_EQ(scan.frames[4].use, FrameUse::Invalid);
    EXPECT_TRUE(scan.frames[4].camera_from_world.isApprox(recorded(4)));
}

TEST(CorrectedScan, RefusesPartsOfDifferentRuns)
{
    Tracked input = tracked(6);
    input.alignment.camera_from_world.pop_back();
    EXPECT_THROW(corrected_scan(input.scan, input.keyframes, input.alignment), InputError);
    Tracked other = tracked(6);
    other.scan.frames.resize(10);
    EXPECT_THROW(corrected_scan(other.scan, other.keyframes, other.alignment), InputError);
}

} // namespace
} // namespace quoin
