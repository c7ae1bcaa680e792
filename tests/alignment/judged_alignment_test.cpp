// Alignments are judged by texels that the solver did not see.
#include "aligned_room.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

using testing::align;
using testing::position_error;
using testing::relative_position_error;
using testing::RoomOptions;
using testing::small_room_params;
using testing::textured_room;
using testing::TexturedRoom;

void expect_input_to_the_bit(const TexturedRoom& room, const Alignment& alignment)
{
    ASSERT_EQ(alignment.camera_from_world.size(), room.scan.frames.size());
    for (std::size_t k = 0; k < room.scan.frames.size(); ++k)
        EXPECT_EQ(alignment.camera_from_world[k].matrix(), room.scan.frames[k].camera_from_world.matrix()) << k;
    ASSERT_EQ(alignment.plane.size(), room.mesh.plane.size());
    for (std::size_t p = 0; p < room.mesh.plane.size(); ++p) {
        EXPECT_EQ(alignment.plane[p].normal, room.mesh.plane[p].normal) << p;
        EXPECT_EQ(alignment.plane[p].offset, room.mesh.plane[p].offset) << p;
    }
    EXPECT_EQ(alignment.color.fx, room.scan.color.fx);
    EXPECT_EQ(alignment.color.cx, room.scan.color.cx);
    EXPECT_EQ(alignment.depth_from_color.matrix(), room.scan.depth_from_color.matrix());
}

// Exact poses under depths that are 8 % too far, by which all else is outweighed.
TexturedRoom room_with_wrong_depths()
{
    auto room = textured_room({.position_noise = 0.0, .rotation_noise = 0.0, .gain_noise = 0.05});
    for (DepthImage& depth : room.depth)
        for (float& z : depth.pixels)
            z *= 1.08f;
    return room;
}

OptimizeTextureParams params_that_lead_astray()
{
    auto params = small_room_params();
    params.lambda_d = 1e6;
    params.huber_depth = 1e3;
    params.depth_gate = params.depth_tolerance = 0.5;
    params.prior_translation = 10.0;
    params.optimize_planes = false;
    return params;
}

TEST(JudgedAlignment, KeepsTheInputToTheBitWhereHeldOutTexelsAreWorseAfterIt)
{
    const auto room = room_with_wrong_depths();
    ::testing::internal::CaptureStderr();
    const auto alignment = align(room, params_that_lead_astray());
    const std::string log = ::testing::internal::GetCapturedStderr();
    ASSERT_TRUE(alignment.held_out);
    EXPECT_TRUE(alignment.held_out->is_input_kept);
    EXPECT_GT(alignment.held_out->optimized, 1.5 * alignment.held_out->input);
    EXPECT_NE(log.find("poses, planes and colour camera stay as they were"), std::string::npos) << log;
    expect_input_to_the_bit(room, alignment);
    for (std::size_t k = 0; k < room.true_gain.size(); ++k)
        EXPECT_NEAR(alignment.gain[k].x() * room.true_gain[k], alignment.gain[0].x() * room.true_gain[0], 0.03)
            << "exposures are those of the input poses";
}

TEST(JudgedAlignment, LosesWithoutAJudgementByHeldOutTexels)
{
    auto params = params_that_lead_astray();
    params.held_out = 0.0;
    const auto room = room_with_wrong_depths();
    const auto alignment = align(room, params);
    EXPECT_FALSE(alignment.held_out);
    EXPECT_GT(position_error(alignment.camera_from_world, room.true_camera_from_world), 0.02);
}

TEST(JudgedAlignment, SaysHowMuchBetterHeldOutTexelsAreAfterIt)
{
    const auto room = textured_room({.gain_noise = 0.12});
    const auto alignment = align(room, small_room_params());
    ASSERT_TRUE(alignment.held_out);
    EXPECT_FALSE(alignment.held_out->is_input_kept);
    EXPECT_LT(alignment.held_out->optimized, 0.2 * alignment.held_out->input);
    EXPECT_LT(relative_position_error(room, alignment), 0.3);
}

TEST(JudgedAlignment, GivesExposuresToTheInputTooBeforeItJudges)
{
    const RoomOptions exact{.position_noise = 0.0, .rotation_noise = 0.0, .gain_noise = 0.2};
    auto params = small_room_params();
    params.optimize_poses = params.optimize_planes = false;
    const auto alignment = align(textured_room(exact), params);
    ASSERT_TRUE(alignment.held_out);
    EXPECT_LT(alignment.held_out->input, 1.0) << "gains of a fifth are not counted";
    EXPECT_NEAR(alignment.held_out->optimized, alignment.held_out->input, 0.01);
}

} // namespace
} // namespace quoin
