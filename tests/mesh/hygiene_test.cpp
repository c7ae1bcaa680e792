#include "mesh/hygiene.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

TriangleMesh tetrahedron()
{
    TriangleMesh mesh;
    mesh.position = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    mesh.face = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
}

TriangleMesh square()
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.face = {{0, 1, 2}, {2, 1, 3}};
    return mesh;
}

TEST(Hygiene, OfATetrahedronIsCleanAndClosed)
{
    const auto found = inspect(tetrahedron());
    EXPECT_EQ(found.euler_characteristic, 2);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.border_edges + found.non_manifold_edges + found.duplicate_faces + found.bow_tie_vertices, 0u);
    EXPECT_EQ(found.folded_pairs + found.inconsistent_edges + found.zero_area_faces + found.slivers, 0u);
}

TEST(Hygiene, MeasuresTheBorderOfASquare)
{
    const auto found = inspect(square());
    EXPECT_EQ(found.border_edges, 4u);
    EXPECT_NEAR(found.border_length, 4.0, 1e-9);
    EXPECT_EQ(found.euler_characteristic, 1);
}

TEST(Hygiene, CountsAnEdgeOfThreeFacesOnceAndNoBowTieAtItsEnds)
{
    auto mesh = square();
    mesh.position.emplace_back(0.5f, 0.5f, 1.0f);
    mesh.face.push_back({1, 2, 4});
    const auto found = inspect(mesh);
    EXPECT_EQ(found.non_manifold_edges, 1u);
    EXPECT_EQ(found.bow_tie_vertices, 0u);
}

TEST(Hygiene, FindsADuplicateFaceWhateverItsOrder)
{
    auto mesh = square();
    mesh.face.push_back({2, 0, 1});
    EXPECT_EQ(inspect(mesh).duplicate_faces, 1u);
}

TEST(Hygiene, FindsTheVertexWhereTwoFansTouch)
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    mesh.face = {{0, 1, 2}, {0, 3, 4}};
    const auto found = inspect(mesh);
    EXPECT_EQ(found.bow_tie_vertices, 1u);
    EXPECT_EQ(found.components, 2u);
}

TEST(Hygiene, TellsAFoldFromAFaceThatRunsTheWrongWay)
{
    auto folded = square();
    folded.position[3] = {0.1f, 0.1f, 0.01f};
    EXPECT_EQ(inspect(folded).folded_pairs, 1u);
    EXPECT_EQ(inspect(folded).inconsistent_edges, 0u);
    auto reversed = square();
    std::swap(reversed.face[1][0], reversed.face[1][1]);
    EXPECT_EQ(inspect(reversed).folded_pairs, 0u);
    EXPECT_EQ(inspect(reversed).inconsistent_edges, 1u);
}

TEST(Hygiene, CountsSliversApartFromFacesWithoutArea)
{
    auto mesh = square();
    mesh.position[0] = {0.5f, 0.495f, 0};
    EXPECT_EQ(inspect(mesh).slivers, 1u);
    mesh.position[0] = {0.5f, 0.5f, 0};
    EXPECT_EQ(inspect(mesh).slivers, 0u);
    EXPECT_EQ(inspect(mesh).zero_area_faces, 1u);
    mesh.face[0] = {1, 1, 2};
    EXPECT_EQ(inspect(mesh).zero_area_faces, 1u);
    EXPECT_EQ(inspect(mesh).isolated_vertices, 1u);
}

TEST(Hygiene, OfPlanesFindsFlippedFacesAndPlanesInPieces)
{
    PlaneMesh mesh;
    mesh.mesh = square();
    mesh.mesh.position.insert(mesh.mesh.position.end(), {{5, 0, 0}, {5, 1, 0}, {6, 0, 0}});
    mesh.mesh.face.push_back({4, 5, 6});
    mesh.plane.assign(3, Plane{});
    mesh.face_plane = {0, 0, 0};
    const auto found = inspect(mesh);
    EXPECT_EQ(found.disconnected_planes, 1u);
    EXPECT_EQ(found.empty_planes, 2u);
    EXPECT_EQ(found.flipped_faces, 1u);
}

TEST(Hygiene, OfNothingIsZero)
{
    const auto found = inspect(PlaneMesh{});
    EXPECT_EQ(found.faces + found.vertices + found.components + found.empty_planes, 0u);
    EXPECT_EQ(found.euler_characteristic, 0);
}

} // namespace
} // namespace quoin
