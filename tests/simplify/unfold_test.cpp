#include "simplify/unfold.h"

#include "mesh/hygiene.h"
#include "support/plane_meshes.h"

#include <gtest/gtest.h>
#include <random>

namespace quoin {
namespace {

using namespace testing_support;

std::size_t manifold_defects(const Hygiene& found)
{
    return found.non_manifold_edges + found.duplicate_faces + found.bow_tie_vertices + found.inconsistent_edges;
}

// A flat front, a back that is a tent below it, and a tab of both beyond their common rim, 1.5 cm long, whose two sides
// lie on each other.
PlaneMesh sheet_with_tab()
{
    PlaneMesh mesh;
    mesh.mesh.position = {{0, 0, 0}, {1, 0, 0},    {1, 0.49f, 0},     {1, 0.51f, 0},      {1, 1, 0},
                          {0, 1, 0}, {1, 0.5f, 0}, {1.015f, 0.5f, 0}, {0.4f, 0.5f, -0.3f}};
    constexpr VertexId middle = 6, tip = 7, top = 8;
    mesh.mesh.face = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}, {2, tip, 3}};
    mesh.face_plane.assign(mesh.mesh.face.size(), 0);
    for (const auto& [a, b] : {std::pair{1u, 0u}, {2u, 1u}, {middle, 2u}, {3u, middle}, {4u, 3u}, {5u, 4u}, {0u, 5u}})
        mesh.mesh.face.push_back({a, b, top});
    mesh.mesh.face.push_back({tip, 2, middle});
    mesh.mesh.face.push_back({3, tip, middle});
    mesh.face_plane.resize(mesh.mesh.face.size(), 1);
    mesh.plane = {{Eigen::Vector3d::UnitZ(), 0.0}, {-Eigen::Vector3d::UnitZ(), 0.0}};
    mesh.moments.resize(2);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    return mesh;
}

TEST(Unfold, TakesATabAwayWhoseSidesLieOnEachOther)
{
    PlaneMesh mesh = sheet_with_tab();
    const Hygiene before = inspect(mesh);
    ASSERT_EQ(manifold_defects(before), 0u);
    ASSERT_EQ(before.euler_characteristic, 2);
    unfold(mesh, {});
    const Hygiene after = inspect(mesh);
    EXPECT_EQ(manifold_defects(after) + after.zero_area_faces + after.flipped_faces, 0u);
    EXPECT_EQ(after.euler_characteristic, 2);
    EXPECT_LT(after.folded_pairs, before.folded_pairs);
    EXPECT_LT(after.faces, before.faces);
}

TEST(Unfold, TakesATabAwayOneSideOfWhichIsAPlaneOfItsOwn)
{
    PlaneMesh mesh = sheet_with_tab();
    constexpr FaceId front = 4;
    mesh.face_plane[front] = 2;
    mesh.plane.push_back(mesh.plane[0]);
    mesh.moments.resize(3);
    const Hygiene before = inspect(mesh);
    unfold(mesh, {});
    const Hygiene after = inspect(mesh);
    EXPECT_EQ(manifold_defects(after) + after.zero_area_faces + after.flipped_faces, 0u);
    EXPECT_LT(after.folded_pairs, before.folded_pairs);
    EXPECT_LT(after.faces, before.faces);
    EXPECT_EQ(std::ranges::count(mesh.face_plane, 2u), 0);
}

TEST(Unfold, LeavesAPatchThatIsTurnedOver)
{
    PlaneMesh mesh = join_sheets({{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, 4}});
    for (const FaceId f : {10u, 11u, 12u, 13u}) {
        std::swap(mesh.mesh.face[f][1], mesh.mesh.face[f][2]);
        mesh.face_plane[f] = 1;
    }
    mesh.plane.push_back(mesh.plane[0].flipped());
    mesh.moments.resize(2);
    const auto faces = mesh.mesh.face;
    unfold(mesh, {});
    EXPECT_EQ(mesh.mesh.face, faces);
}

TEST(Unfold, LeavesASheetThatIsLargerThanTheError)
{
    PlaneMesh mesh = sheet_with_tab();
    unfold(mesh, {.max_fold_error = 0.001});
    EXPECT_EQ(mesh.mesh.face, sheet_with_tab().mesh.face);
    unfold(mesh, {.max_fold_error = 0.0});
    EXPECT_EQ(mesh.mesh.face, sheet_with_tab().mesh.face);
}

// A curtain's fold, 2 m high and 6 cm deep: front and back meet in a common rim, no farther than 1.8 cm from each
// other. Their strips are so narrow that each alone would be within the error.
PlaneMesh curtain_fold()
{
    constexpr VertexId strips = 4;
    constexpr float height = 2.0f, width = 0.06f, gap = 0.018f;
    PlaneMesh mesh;
    for (VertexId i = 0; i <= 2 * strips; ++i) { // along the front to the rim and along the back from it
        const float away = std::abs(1.0f - float(i) / strips);
        const Eigen::Vector3f at(width * (1.0f - away), i > strips ? gap * away : 0.0f, 0.0f);
        mesh.mesh.position.push_back(at);
        mesh.mesh.position.push_back(at + Eigen::Vector3f(0, 0, height));
    }
    for (VertexId i = 0; i < 2 * strips; ++i) {
        mesh.mesh.face.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        mesh.mesh.face.push_back({2 * i, 2 * i + 3, 2 * i + 1});
        mesh.face_plane.insert(mesh.face_plane.end(), 2, i < strips ? 0u : 1u);
    }
    const Eigen::Vector3d back = Eigen::Vector3d(gap, width, 0.0).normalized();
    mesh.plane = {{-Eigen::Vector3d::UnitY(), 0.0}, {back, -back.x() * width}};
    mesh.moments.resize(2);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    return mesh;
}

TEST(Unfold, LeavesALongThinSheetWhoseSidesAreNearEachOther)
{
    PlaneMesh mesh = curtain_fold();
    ASSERT_EQ(inspect(mesh).folded_pairs, 1u);
    const auto faces = mesh.mesh.face;
    unfold(mesh, {});
    EXPECT_EQ(mesh.mesh.face, faces);
}

TEST(Unfold, TakesAFaceWithoutAreaOutThatIsAllOfItsPlane)
{
    PlaneMesh mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1}});
    mesh.mesh.position.emplace_back(0.01f, 0.0f, 0.0f); // on the edge from 0 to 1
    mesh.mesh.face.push_back({1, 0, 4});
    mesh.face_plane.push_back(1);
    mesh.plane.push_back({Eigen::Vector3d::UnitY(), 0.0});
    mesh.moments.emplace_back();
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    ASSERT_EQ(inspect(mesh).zero_area_faces, 1u);
    unfold(mesh, {});
    const Hygiene after = inspect(mesh);
    EXPECT_EQ(after.zero_area_faces + after.flipped_faces + manifold_defects(after), 0u);
}

TEST(Unfold, LeavesAMeshWithoutDefectsAsItIs)
{
    PlaneMesh mesh = box({1, 1, 1}, 4);
    const auto before = mesh;
    unfold(mesh, {});
    EXPECT_EQ(mesh.mesh.face, before.mesh.face);
    EXPECT_TRUE(mesh.mesh.position == before.mesh.position);
}

// A vertex pulled over its neighbour turns faces over inside a plane.
TEST(Unfold, TurnsFacesBackThatLookAway)
{
    PlaneMesh mesh = join_sheets({{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, 10}});
    mesh.mesh.position[5 * 11 + 5].x() += 0.015f;
    ASSERT_GT(inspect(mesh).flipped_faces, 0u);
    unfold(mesh, {});
    const Hygiene after = inspect(mesh);
    EXPECT_EQ(after.flipped_faces + after.folded_pairs + after.zero_area_faces + manifold_defects(after), 0u);
}

TEST(Unfold, NeverWorsensAMeshOfRandomNoise)
{
    for (unsigned seed = 0; seed < 4; ++seed) {
        PlaneMesh mesh = with_noise(box({0.3, 0.3, 0.3}, 10), 0.015f, seed);
        const Hygiene before = inspect(mesh);
        unfold(mesh, {});
        const Hygiene after = inspect(mesh);
        EXPECT_EQ(manifold_defects(after), 0u) << seed;
        EXPECT_EQ(after.euler_characteristic, 2) << seed;
        EXPECT_EQ(after.disconnected_planes + after.empty_planes, 0u) << seed;
        EXPECT_LE(after.folded_pairs + 2 * after.flipped_faces, before.folded_pairs + 2 * before.flipped_faces) << seed;
    }
}

} // namespace
} // namespace quoin
