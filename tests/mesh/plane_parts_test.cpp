#include "mesh/plane_parts.h"

#include "mesh/hygiene.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using namespace testing_support;
using testing::Each;

std::size_t defects(const PlaneMesh& mesh)
{
    const Hygiene found = inspect(mesh);
    return found.flipped_faces + found.disconnected_planes + found.empty_planes;
}

// Faces of `sheet` go over to the plane of another one.
void give(PlaneMesh& mesh, PlaneId sheet, PlaneId plane)
{
    std::ranges::replace(mesh.face_plane, sheet, plane);
    mesh.plane.erase(mesh.plane.begin() + sheet);
    mesh.moments.erase(mesh.moments.begin() + sheet);
    for (PlaneId& p : mesh.face_plane)
        if (p > sheet) --p;
}

// Two strips with a step up between them.
PlaneMesh strips(double step)
{
    return join_sheets({{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 2},
                        {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, step}, 2},
                        {{0.0, 1.0, step}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 2}});
}

TEST(SeparateParts, LeavesPlanesInOnePieceAlone)
{
    for (const auto kind : {PlaneParts::Joined, PlaneParts::OneSided}) {
        PlaneMesh mesh = box({1, 1, 1}, 3);
        const auto before = mesh;
        separate_parts(mesh, 0.01, kind);
        EXPECT_EQ(mesh.face_plane, before.face_plane);
        EXPECT_EQ(mesh.plane.size(), before.plane.size());
    }
}

TEST(SeparateParts, MakesAPlaneOfItsOwnOfThePartThatHangsOnNothing)
{
    PlaneMesh mesh = strips(0.2);
    give(mesh, 2, 0);
    ASSERT_EQ(inspect(mesh).disconnected_planes, 1u);
    separate_parts(mesh, 0.01, PlaneParts::Joined);
    EXPECT_EQ(defects(mesh), 0u);
    EXPECT_EQ(mesh.plane.size(), 3u);
    EXPECT_NEAR(mesh.moments[2].area, 1.0, 1e-6);
}

// A fin that hangs down from the edge of a sheet counted to it, bent back underneath.
PlaneMesh sheet_with_fin(const Eigen::Vector3d& down)
{
    PlaneMesh mesh = join_sheets(
        {{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 4}, {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, down, 4}});
    give(mesh, 1, 0);
    return mesh;
}

TEST(SeparateParts, GivesFacesThatLookAwayAPlaneThatTheyFace)
{
    PlaneMesh mesh = sheet_with_fin({0.0, -0.1, -0.1});
    ASSERT_EQ(inspect(mesh).flipped_faces, 32u);
    PlaneMesh joined = mesh;
    separate_parts(joined, 0.01, PlaneParts::Joined);
    EXPECT_EQ(joined.face_plane, mesh.face_plane);
    separate_parts(mesh, 0.01, PlaneParts::OneSided);
    EXPECT_EQ(defects(mesh), 0u);
    ASSERT_EQ(mesh.plane.size(), 2u);
    EXPECT_NEAR(mesh.plane[1].normal.dot(Eigen::Vector3d(0.0, 1.0, -1.0).normalized()), 1.0, 1e-6);
    EXPECT_NEAR(mesh.plane[1].signed_distance({0.5, 0.95, -0.05}), 0.0, 1e-6);
}

TEST(SeparateParts, GivesFacesThatLookAwayToAPlaneBesideThem)
{
    PlaneMesh mesh = sheet_with_fin({0.0, -0.1, -0.1});
    const PlaneMesh apart = join_sheets({{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 4},
                                         {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, -0.1, -0.1}, 4}});
    mesh.plane.push_back(apart.plane[1]);
    mesh.moments.push_back(apart.moments[1]);
    mesh.face_plane.back() = 1;
    separate_parts(mesh, 0.01, PlaneParts::OneSided);
    EXPECT_EQ(defects(mesh), 0u);
    EXPECT_EQ(mesh.face_plane, apart.face_plane);
}

TEST(SeparateParts, TurnsAPlaneThatAllOfItsFacesLookAwayFrom)
{
    PlaneMesh mesh = box({1, 1, 1}, 3);
    mesh.plane[2] = mesh.plane[2].flipped();
    const auto before = mesh.face_plane;
    separate_parts(mesh, 0.01, PlaneParts::OneSided);
    EXPECT_EQ(defects(mesh), 0u);
    EXPECT_EQ(mesh.face_plane, before);
}

TEST(SeparateParts, EndsWithoutFacesThatLookAwayWhateverTheyDo)
{
    for (unsigned seed = 0; seed < 4; ++seed) {
        PlaneMesh mesh = with_noise(box({0.3, 0.3, 0.3}, 10), 0.03f, seed);
        ASSERT_GT(inspect(mesh).flipped_faces, 20u);
        separate_parts(mesh, 0.01, PlaneParts::OneSided);
        EXPECT_EQ(defects(mesh), 0u) << seed;
    }
}

} // namespace
} // namespace quoin
