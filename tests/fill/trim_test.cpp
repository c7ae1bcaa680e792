#include "fill/trim.h"

#include "mesh/hygiene.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using namespace testing_support;

// A sheet of 4 x 4 squares in plane 0, facing up, and behind its faces those of a patch.
struct Patched {
    PlaneMesh mesh = join_sheets({{{0.0, 0.0, 0.0}, {0.4, 0.0, 0.0}, {0.0, 0.4, 0.0}, 4}});
    FaceId known = static_cast<FaceId>(mesh.mesh.face.size());

    VertexId at(float x, float y) const
    {
        const auto& p = mesh.mesh.position;
        const auto is_there = [&](const auto& q) { return (q - Eigen::Vector3f(x, y, 0.0f)).norm() < 1e-4f; };
        return static_cast<VertexId>(std::find_if(p.begin(), p.end(), is_there) - p.begin());
    }
    VertexId add_vertex(float x, float y, float z)
    {
        mesh.mesh.position.emplace_back(x, y, z);
        return static_cast<VertexId>(mesh.mesh.position.size() - 1);
    }
    void add_face(VertexId a, VertexId b, VertexId c, PlaneId plane = 0)
    {
        mesh.mesh.face.push_back({a, b, c});
        mesh.face_plane.push_back(plane);
    }
    void trim() { trim_patches(mesh, known, 0.01); }
};

TEST(TrimPatches, LeavesFacesThatContinueTheSurface)
{
    Patched patched;
    patched.add_face(patched.at(0.4f, 0.1f), patched.add_vertex(0.5f, 0.1f, 0.0f), patched.at(0.4f, 0.2f));
    const auto before = patched.mesh;
    patched.trim();
    EXPECT_EQ(patched.mesh.mesh.face, before.mesh.face);
    EXPECT_EQ(patched.mesh.mesh.position, before.mesh.position);
}

TEST(TrimPatches, TakesFacesOutThatFoldOrLookAway)
{
    Patched patched;
    patched.mesh.plane.push_back({-Eigen::Vector3d::UnitX(), 0.4});
    // Back under the sheet; and, on a plane that faces the other way, upright.
    patched.add_face(patched.at(0.4f, 0.1f), patched.add_vertex(0.3f, 0.15f, -0.01f), patched.at(0.4f, 0.2f));
    patched.add_face(patched.at(0.4f, 0.2f), patched.add_vertex(0.4f, 0.25f, -0.1f), patched.at(0.4f, 0.3f), 1);
    ASSERT_EQ(inspect(patched.mesh).folded_pairs, 1u);
    ASSERT_EQ(inspect(patched.mesh).flipped_faces, 2u);
    patched.trim();
    EXPECT_EQ(patched.mesh.mesh.face.size(), patched.known);
    EXPECT_EQ(patched.mesh.face_plane.size(), patched.known);
    EXPECT_EQ(inspect(patched.mesh).isolated_vertices, 0u);
}

TEST(TrimPatches, KeepsThePartOfAPatchThatDoesNotFold)
{
    Patched patched;
    const VertexId tip = patched.add_vertex(0.5f, 0.15f, 0.0f);
    patched.add_face(patched.at(0.4f, 0.1f), tip, patched.at(0.4f, 0.2f));
    patched.add_face(tip, patched.add_vertex(0.45f, 0.2f, 0.01f), patched.at(0.4f, 0.2f));  // continues
    patched.add_face(patched.at(0.4f, 0.1f), patched.add_vertex(0.45f, 0.16f, 0.02f), tip); // turns back over it
    ASSERT_EQ(inspect(patched.mesh).folded_pairs, 1u);
    patched.trim();
    EXPECT_EQ(patched.mesh.mesh.face.size(), patched.known + 2);
    EXPECT_EQ(inspect(patched.mesh).folded_pairs, 0u);
}

TEST(TrimPatches, LeavesNoFanThatTouchesInAVertexAlone)
{
    Patched patched;
    const VertexId tip = patched.add_vertex(0.5f, 0.2f, 0.0f);
    patched.add_face(patched.at(0.4f, 0.1f), tip, patched.at(0.4f, 0.2f));
    patched.add_face(patched.at(0.4f, 0.3f), tip, patched.at(0.4f, 0.4f));
    ASSERT_EQ(inspect(patched.mesh).bow_tie_vertices, 1u);
    patched.trim();
    const Hygiene after = inspect(patched.mesh);
    EXPECT_EQ(after.bow_tie_vertices, 0u);
    EXPECT_EQ(after.faces, patched.known + 2u);
    EXPECT_EQ(patched.mesh.mesh.position.size(), tip + 2u);
}

TEST(TrimPatches, GivesStrangersToThePlaneBesideThem)
{
    Patched patched;
    patched.mesh.plane.push_back({Eigen::Vector3d::UnitZ(), 5.0});
    patched.add_face(patched.at(0.4f, 0.1f), patched.add_vertex(0.5f, 0.15f, 0.005f), patched.at(0.4f, 0.2f), 1);
    patched.add_face(patched.at(0.4f, 0.2f), patched.add_vertex(0.5f, 0.25f, 0.05f), patched.at(0.4f, 0.3f), 1);
    patched.trim();
    EXPECT_EQ(patched.mesh.mesh.face.size(), patched.known + 1);
    EXPECT_THAT(patched.mesh.face_plane, testing::Each(0u));
}

} // namespace
} // namespace quoin
