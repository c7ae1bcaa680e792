#include "mesh/flip_guard.h"

#include "mesh/hygiene.h"
#include "support/plane_meshes.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

using namespace testing_support;

// Two faces of one plane on the edge from a to b.
PlaneMesh two_faces()
{
    PlaneMesh mesh;
    mesh.mesh.position = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0.5f, -1, 0}};
    mesh.mesh.face = {{0, 1, 2}, {1, 0, 3}};
    mesh.face_plane = {0, 1};
    mesh.plane = {{Eigen::Vector3d::UnitZ(), 0.0}, {Eigen::Vector3d::UnitZ(), 0.0}};
    mesh.moments.resize(2);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    return mesh;
}

TEST(FlipGuard, LetsPassWhatTurnsNothingOver)
{
    const auto before = two_faces();
    auto moved = before;
    moved.mesh.position[2] += Eigen::Vector3f(0.1f, 0.2f, 0.1f);
    const auto wanted = moved.mesh.position;
    EXPECT_EQ(hold_back_flips(moved, before.mesh.position, {.min_cosine = 0.5}), 0u);
    EXPECT_TRUE(moved.mesh.position == wanted);
}

TEST(FlipGuard, HoldsBackAFaceThatWouldTurnOver)
{
    const auto before = two_faces();
    auto moved = before;
    moved.mesh.position[2].y() = -0.5f;
    EXPECT_GT(hold_back_flips(moved, before.mesh.position, {.min_cosine = 0.5}), 0u);
    EXPECT_EQ(inspect(moved).flipped_faces, 0u);
    EXPECT_EQ(inspect(moved).folded_pairs, 0u);
}

TEST(FlipGuard, HoldsBackFacesThatWouldFoldThoughEachLooksAlongItsPlane)
{
    auto before = two_faces();
    before.plane[0] = {Eigen::Vector3d(0, 0.9, 0.1).normalized(), 0.0};
    before.plane[1] = {Eigen::Vector3d(0, -0.9, 0.1).normalized(), 0.0};
    auto moved = before;
    moved.mesh.position[2] = {0.5f, 0.05f, -1.0f};
    moved.mesh.position[3] = {0.5f, -0.05f, -1.0f};
    EXPECT_GT(hold_back_flips(moved, before.mesh.position, {}), 0u);
    EXPECT_EQ(inspect(moved).folded_pairs, 0u);
}

TEST(FlipGuard, KeepsFacesFromShrinkingToALine)
{
    const auto before = two_faces();
    auto moved = before;
    moved.mesh.position[2].y() = 0.0f;
    EXPECT_GT(hold_back_flips(moved, before.mesh.position, {}), 0u);
    EXPECT_EQ(inspect(moved).zero_area_faces + inspect(moved).slivers, 0u);
}

TEST(FlipGuard, LeavesAFoldThatWasThereFreeToMove)
{
    auto before = two_faces();
    before.plane[1] = before.plane[1].flipped();
    before.mesh.position[3] = {0.5f, 1.0f, -0.2f};
    auto moved = before;
    moved.mesh.position[3].z() = -0.1f;
    EXPECT_EQ(hold_back_flips(moved, before.mesh.position, {}), 0u);
}

TEST(FlipGuard, NeverWorsensABoxThatIsShaken)
{
    for (unsigned seed = 0; seed < 4; ++seed) {
        const auto before = box({1, 1, 1}, 8);
        auto moved = with_noise(before, 0.08f, seed);
        hold_back_flips(moved, before.mesh.position, {.min_cosine = 0.5});
        const auto found = inspect(moved);
        EXPECT_EQ(found.flipped_faces + found.folded_pairs + found.zero_area_faces + found.slivers, 0u) << seed;
    }
}

} // namespace
} // namespace quoin
