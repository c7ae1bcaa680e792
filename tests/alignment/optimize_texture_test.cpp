#include "aligned_room.h"
#include "alignment/state.h"
#include "base/error.h"
#include "base/parallel.h"
#include "image/sampling.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

using testing::align;
using testing::input_poses;
using testing::position_error;
using testing::relative_position_error;
using testing::RoomOptions;
using testing::small_room_params;
using testing::textured_room;
using testing::TexturedRoom;

void expect_input_poses(const TexturedRoom& room, const Alignment& alignment)
{
    ASSERT_EQ(alignment.camera_from_world.size(), room.scan.frames.size());
    for (std::size_t k = 0; k < room.scan.frames.size(); ++k)
        EXPECT_TRUE(alignment.camera_from_world[k].isApprox(room.scan.frames[k].camera_from_world, 0.0)) << k;
}

void expect_finite(const Alignment& alignment)
{
    for (const Rigid& pose : alignment.camera_from_world)
        EXPECT_TRUE(is_rigid(pose.matrix(), 1e-9));
    for (const Plane& plane : alignment.plane)
        EXPECT_TRUE(plane.normal.allFinite() && std::isfinite(plane.offset));
    for (const auto& gain : alignment.gain)
        EXPECT_TRUE(gain.allFinite());
    for (const auto& bias : alignment.bias)
        EXPECT_TRUE(bias.allFinite());
    for (const auto& row : alignment.energy)
        for (const double value : row)
            EXPECT_TRUE(std::isfinite(value));
}

// A square of 2 m on a plane.
Moments moments_of_square(const Plane& plane, const Eigen::Vector3d& center)
{
    const Eigen::Vector3d u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
    Moments moments = triangle_moments(center - u - v, center + u - v, center + u + v);
    moments += triangle_moments(center - u - v, center + u + v, center - u + v);
    return moments;
}

// Out of focus: a mean over 31 pixels each way leaves no texture.
ColorImage blurred(const ColorImage& image)
{
    constexpr int kRadius = 15;
    ColorImage result(image.width, image.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            int sum = 0, count = 0;
            for (int v = std::max(0, y - kRadius); v <= std::min(image.height - 1, y + kRadius); ++v)
                for (int u = std::max(0, x - kRadius); u <= std::min(image.width - 1, x + kRadius); ++u, ++count)
                    sum += image.at(u, v)[0];
            result.at(x, y).fill(static_cast<std::uint8_t>(sum / count));
        }
    return result;
}

TEST(OptimizeTexture, BringsDisturbedCamerasBack)
{
    const auto room = textured_room({});
    const auto alignment = align(room, small_room_params());
    EXPECT_LT(relative_position_error(room, alignment), 0.2);
}

TEST(OptimizeTexture, BringsDisturbedCamerasBackByColourAlone)
{
    const auto room = textured_room({.with_depth = false});
    const auto alignment = align(room, small_room_params());
    EXPECT_LT(relative_position_error(room, alignment),
              0.5); // along the planes' common directions only the prior holds
}

TEST(OptimizeTexture, BringsDisturbedCamerasBackByThePapersScheduleToo)
{
    const auto room = textured_room({});
    auto params = small_room_params();
    params.solver = AlignmentSolver::Alternating;
    EXPECT_LT(relative_position_error(room, align(room, params)), 0.5);
}

TEST(OptimizeTexture, LowersTheMeanEnergyFromRowToRow)
{
    const auto room = textured_room({});
    for (const auto solver : {AlignmentSolver::Joint, AlignmentSolver::Alternating}) {
        auto params = small_room_params();
        params.solver = solver;
        const auto energy = align(room, params).energy;
        ASSERT_GE(energy.size(), 3u);
        for (std::size_t i = 1; i < energy.size(); ++i)
            EXPECT_LE(energy[i][0], 1.01 * energy[i - 1][0]) << i;
        EXPECT_LT(energy.back()[1], 0.3 * energy.front()[1]);
    }
}

TEST(OptimizeTexture, MovesPlanesToTheirTrueOffsetsUnderTrueCameras)
{
    const auto room = textured_room({.position_noise = 0.0, .rotation_noise = 0.0, .plane_error = 0.01});
    auto params = small_room_params();
    params.optimize_poses = false;
    params.lambda_p = 0.0;
    for (const double lambda_d : {0.0, 1.0}) { // by colour alone, and with depth
        params.lambda_d = lambda_d;
        const auto alignment = align(room, params);
        for (const std::size_t wall : {0, 4}) // those in view
            EXPECT_NEAR(alignment.plane[wall].offset, room.true_plane[wall].offset, 0.003) << lambda_d;
    }
}

// Where the normal and the cluster of a wall are 2 degrees off, depths and colours turn it back by more than half.
TEST(OptimizeTexture, KeepsNormalsThatWouldTurnBeyondBelief)
{
    auto room = textured_room({.position_noise = 0.0, .rotation_noise = 0.0});
    const Plane truth = room.true_plane[0];
    const Eigen::Vector3d center = room.mesh.moments[0].centroid();
    const Eigen::AngleAxisd turn(2.0 * std::numbers::pi / 180.0, truth.normal.unitOrthogonal());
    const Eigen::Vector3d turned = turn * truth.normal;
    room.mesh.plane[0] = {turned, -turned.dot(center)};
    room.mesh.moments[0] = moments_of_square(room.mesh.plane[0], center);
    auto params = small_room_params();
    params.optimize_poses = false;
    const auto angle_to_truth = [&](double max_rotation, double max_tilt) {
        params.max_rotation = max_rotation;
        params.max_tilt = max_tilt;
        const double cosine = align(room, params).plane[0].normal.dot(truth.normal);
        return std::acos(std::min(1.0, cosine)) * 180.0 / std::numbers::pi;
    };
    EXPECT_LT(angle_to_truth(10.0, 0.005), 1.0);
    EXPECT_LT(angle_to_truth(1.0, 0.5), 1.0);
    EXPECT_NEAR(angle_to_truth(1.0, 0.005), 2.0, 1e-6);
}

TEST(OptimizeTexture, FindsTheGainsOfTheFrames)
{
    const auto room = textured_room({.gain_noise = 0.12});
    const auto alignment = align(room, small_room_params());
    double mean_log = 0.0;
    for (std::size_t k = 0; k < room.true_gain.size(); ++k)
        mean_log += std::log(room.true_gain[k]) / 8.0;
    for (std::size_t k = 0; k < room.true_gain.size(); ++k) {
        const double corrected = room.true_gain[k] / std::exp(mean_log) * alignment.gain[k].x();
        EXPECT_NEAR(corrected, 1.0, 0.03) << k;
        EXPECT_NEAR(alignment.bias[k].x(), 0.0, 4.0) << k;
    }
    EXPECT_LT(relative_position_error(room, alignment), 0.3);
}

TEST(OptimizeTexture, FindsTheVignettingOfTheLens)
{
    for (const double loss : {0.0, 0.15, 0.4}) {
        const auto room = textured_room({.gain_noise = 0.12, .vignetting = loss});
        const auto alignment = align(room, small_room_params());
        for (const double squared_radius : {0.2, 0.5, 0.8})
            EXPECT_NEAR(alignment.vignetting.correction(squared_radius) * (1.0 - loss * squared_radius), 1.0, 0.02)
                << loss << " at " << squared_radius;
        EXPECT_LT(relative_position_error(room, alignment), 0.3) << loss;
    }
}

TEST(OptimizeTexture, FindsNoVignettingWhereNothingTellsOfIt)
{
    auto params = small_room_params();
    EXPECT_TRUE(align(textured_room({.textured = false}), params).vignetting.k.isZero(0.02f));
    params.optimize_vignetting = false;
    EXPECT_TRUE(align(textured_room({.vignetting = 0.4}), params).vignetting.k.isZero());
}

// Mean distance between where two colour cameras see the same points of the depth camera [px].
double pixel_difference(const TexturedRoom& room, const Alignment& alignment, const Camera& color,
                        const Rigid& color_from_depth)
{
    double sum = 0.0;
    int count = 0;
    for (int y = 10; y < room.scan.depth.height; y += 20)
        for (int x = 10; x < room.scan.depth.width; x += 20, ++count) {
            const Eigen::Vector3d p = room.scan.depth.ray({x, y}) * 2.0;
            sum += (alignment.color.project(alignment.depth_from_color.inverse() * p) -
                    color.project(color_from_depth * p))
                       .norm();
        }
    return sum / count;
}

TEST(OptimizeTexture, FindsTheCalibrationOfTheColourCamera)
{
    const Rigid color_from_depth = exp_twist(twist({0.004, -0.006, 0.003}, {0.02, -0.01, 0.005}));
    auto room = textured_room({.position_noise = 0.002, .rotation_noise = 0.001, .color_from_depth = color_from_depth});
    const Camera color = room.scan.color;
    room.scan.depth_from_color = Rigid::Identity();
    room.scan.color.cx += 1.0;
    auto params = small_room_params();
    const auto fixed = align(room, params);
    EXPECT_EQ(fixed.color.cx, room.scan.color.cx);
    params.calibration = CalibrationUse::Refine;
    const auto refined = align(room, params);
    EXPECT_LT(refined.energy.back()[0], 0.7 * fixed.energy.back()[0]);
    EXPECT_LT(pixel_difference(room, refined, color, color_from_depth),
              0.3 * pixel_difference(room, fixed, color, color_from_depth));
}

TEST(OptimizeTexture, RefinesTheColourCameraOnlyWhereColoursAgreeClearlyBetterThen)
{
    auto params = small_room_params();
    params.calibration = CalibrationUse::Auto;
    const auto well_described = textured_room({.position_noise = 0.005, .rotation_noise = 0.003});
    EXPECT_EQ(align(well_described, params).color.fx, well_described.scan.color.fx);
    const Rigid color_from_depth = exp_twist(twist({0.01, -0.02, 0.02}, {0.03, -0.02, 0.02}));
    auto room = textured_room({.position_noise = 0.002, .rotation_noise = 0.001, .color_from_depth = color_from_depth});
    room.scan.depth_from_color = Rigid::Identity();
    const Camera color = room.scan.color;
    const auto refined = align(room, params);
    params.calibration = CalibrationUse::Fixed;
    EXPECT_LT(pixel_difference(room, refined, color, color_from_depth),
              0.3 * pixel_difference(room, align(room, params), color, color_from_depth));
}

TEST(OptimizeTexture, KeepsThePosesOfARoomWithoutTextureNearWhereDepthHoldsThem)
{
    const auto room = textured_room({.position_noise = 0.002, .rotation_noise = 0.001, .textured = false});
    ::testing::internal::CaptureStderr();
    const auto alignment = align(room, small_room_params());
    const std::string log = ::testing::internal::GetCapturedStderr();
    expect_finite(alignment);
    EXPECT_LT(position_error(alignment.camera_from_world, room.true_camera_from_world), 0.003);
    EXPECT_NE(log.find("next to no texture to align by"), std::string::npos) << log;
    EXPECT_NE(log.find("Poses stay as the depth has them"), std::string::npos) << log;
}

TEST(OptimizeTexture, DoesNotWarnOfMissingTextureWhereThereIsSome)
{
    ::testing::internal::CaptureStderr();
    align(textured_room({.frames = 3}), small_room_params());
    EXPECT_EQ(::testing::internal::GetCapturedStderr().find("texture"), std::string::npos);
}

TEST(OptimizeTexture, KeepsTheInputPosesWhenNothingCanBeSeen)
{
    auto room = textured_room({.frames = 3, .saturated = true, .with_depth = false});
    const auto alignment = align(room, small_room_params());
    expect_finite(alignment);
    expect_input_poses(room, alignment);
}

TEST(OptimizeTexture, AcceptsOneKeyframeAndNone)
{
    auto room = textured_room({.frames = 1});
    const auto one = align(room, small_room_params());
    expect_finite(one);
    EXPECT_EQ(one.camera_from_world.size(), 1u);
    room.keyframes.frame.clear();
    const auto none = align(room, small_room_params());
    expect_finite(none);
    EXPECT_TRUE(none.camera_from_world.empty());
    EXPECT_EQ(none.plane.size(), room.mesh.plane.size());
}

TEST(OptimizeTexture, HoldsBlurredAndSaturatedFramesByDepth)
{
    for (const bool saturated : {false, true}) {
        auto room = textured_room({.saturated = saturated});
        for (ColorImage& image : room.color)
            image = blurred(image);
        const auto alignment = align(room, small_room_params());
        expect_finite(alignment);
        EXPECT_LT(relative_position_error(room, alignment), 0.8) << (saturated ? "saturated" : "blurred");
    }
}

TEST(OptimizeTexture, AlignsTheFramesBeforeAJumpOfThePosesAndSendsNoneFarther)
{
    for (const double jump : {0.25, 0.5, 1.5}) { // [m]
        auto room = textured_room({});
        for (std::size_t k = 4; k < 8; ++k)
            room.scan.frames[k].camera_from_world.translation() += jump * Eigen::Vector3d(0.7, -0.4, 0.6);
        const auto alignment = align(room, small_room_params());
        expect_finite(alignment);
        const auto error_of = [&](std::size_t k, const std::vector<Rigid>& poses) {
            return position_error({poses[k]}, {room.true_camera_from_world[k]});
        };
        for (std::size_t k = 0; k < 4; ++k)
            EXPECT_LT(error_of(k, alignment.camera_from_world), 0.005) << jump << " m: frame " << k;
        for (std::size_t k = 4; k < 8; ++k)
            EXPECT_LT(error_of(k, alignment.camera_from_world), 1.05 * error_of(k, input_poses(room)))
                << jump << " m: frame " << k;
    }
}

TEST(OptimizeTexture, TakesColourOfAnotherSizeThanDepth)
{
    auto room = textured_room({});
    room.scan.color = room.scan.color.at_level(1);
    for (ColorImage& image : room.color)
        image = half_size(image);
    const auto alignment = align(room, small_room_params());
    expect_finite(alignment);
    EXPECT_LT(relative_position_error(room, alignment), 0.3);
}

TEST(OptimizeTexture, IsNotLedAstrayByDepthOfOtherFrames)
{
    auto room = textured_room({});
    std::ranges::rotate(room.depth, room.depth.begin() + 3);
    const auto alignment = align(room, small_room_params());
    expect_finite(alignment);
    EXPECT_LE(relative_position_error(room, alignment), 1.0);
}

TEST(OptimizeTexture, LeavesAPlaneAloneThatIsSeenEdgeOnOnly)
{
    auto room = textured_room({.frames = 1, .position_noise = 0.0, .rotation_noise = 0.0});
    const Eigen::Vector3d eye = room.true_camera_from_world[0].inverse().translation();
    const auto first = static_cast<VertexId>(room.mesh.mesh.position.size());
    for (const auto& [x, z] : {std::pair(0.3, 0.4), {0.9, 0.4}, {0.3, 0.9}}) // a fin in the plane y = eye.y
        room.mesh.mesh.position.push_back(Eigen::Vector3d(x, eye.y(), z).cast<float>());
    room.mesh.mesh.face.push_back({first, first + 1, first + 2});
    room.mesh.face_plane.push_back(6);
    room.mesh.plane.push_back({Eigen::Vector3d::UnitY(), -eye.y()});
    const auto corner = [&](VertexId v) -> Eigen::Vector3d {
        return room.mesh.mesh.position[first + v].cast<double>();
    };
    room.mesh.moments.push_back(triangle_moments(corner(0), corner(1), corner(2)));
    room.mesh.vertex_class = classify_vertices(room.mesh.mesh, room.mesh.face_plane);
    const auto alignment = align(room, small_room_params());
    expect_finite(alignment);
    EXPECT_NEAR(alignment.plane[6].offset, -eye.y(), 1e-3);
    EXPECT_GT(alignment.plane[6].normal.y(), 0.9999);
}

TEST(OptimizeTexture, LeavesAFrameThatSeesNothingWhereItWas)
{
    auto room = textured_room({});
    Rigid outside = Rigid::Identity();
    outside.translation() = Eigen::Vector3d(0, 0, -50);
    room.scan.frames[3].camera_from_world = outside.inverse();
    const auto alignment = align(room, small_room_params());
    EXPECT_TRUE(alignment.camera_from_world[3].isApprox(room.scan.frames[3].camera_from_world, 0.0));
    expect_finite(alignment);
}

TEST(OptimizeTexture, KeepsWhatItIsToldNotToMove)
{
    const auto room = textured_room({.frames = 4});
    auto params = small_room_params();
    params.optimize_poses = false;
    params.optimize_planes = false;
    params.optimize_exposure = false;
    const auto alignment = align(room, params);
    expect_input_poses(room, alignment);
    for (std::size_t p = 0; p < 6; ++p)
        EXPECT_NEAR(alignment.plane[p].offset, room.mesh.plane[p].offset, 1e-12);
    for (const auto& gain : alignment.gain)
        EXPECT_EQ(gain, Eigen::Vector3f::Ones());
}

TEST(OptimizeTexture, RefusesADepthRangeThatIsEmpty)
{
    const auto room = textured_room({.frames = 1});
    auto params = small_room_params();
    params.min_depth = params.max_depth;
    EXPECT_THROW(align(room, params), UsageError);
}

void expect_same_scores(const Alignment& a, const Alignment& b)
{
    ASSERT_TRUE(a.held_out && b.held_out);
    EXPECT_EQ(a.held_out->input, b.held_out->input);
    EXPECT_EQ(a.held_out->optimized, b.held_out->optimized);
    EXPECT_EQ(a.held_out->is_input_kept, b.held_out->is_input_kept);
}

TEST(OptimizeTexture, GivesTheSameBytesForAnyNumberOfThreads)
{
    const auto room = textured_room({.frames = 5, .gain_noise = 0.05});
    const auto losing_room = room_with_wrong_depths();
    set_thread_count(1);
    const auto expected = align(room, small_room_params());
    const auto expected_input = align(losing_room, params_that_lead_astray());
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        const auto alignment = align(room, small_room_params());
        expect_same_scores(alignment, expected);
        const auto input = align(losing_room, params_that_lead_astray());
        expect_same_scores(input, expected_input);
        EXPECT_EQ(input.gain, expected_input.gain);
        for (std::size_t k = 0; k < 5; ++k)
            EXPECT_EQ(alignment.camera_from_world[k].matrix(), expected.camera_from_world[k].matrix());
        for (std::size_t p = 0; p < 6; ++p)
            EXPECT_EQ(alignment.plane[p].offset, expected.plane[p].offset);
        EXPECT_EQ(alignment.gain, expected.gain);
        EXPECT_EQ(alignment.energy, expected.energy);
    }
    set_thread_count(0);
}

} // namespace
} // namespace quoin
