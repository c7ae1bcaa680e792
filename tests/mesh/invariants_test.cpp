#include "mesh/invariants.h"

#include "support/plane_meshes.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

using testing_support::box;

TEST(Invariants, HoldForABox)
{
    EXPECT_EQ(broken_promise_of_planes(box({1, 1, 1}, 3)), "");
    EXPECT_EQ(broken_promise_of_light_mesh(box({1, 1, 1}, 3)), "");
}

TEST(Invariants, NameWhatIsWrongWithLabels)
{
    PlaneMesh mesh = box({1, 1, 1}, 1);
    mesh.face_plane[0] = 6;
    EXPECT_EQ(broken_promise_of_planes(mesh), "a face of plane 6 of 6");
    mesh.face_plane = {1, 1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
    EXPECT_EQ(broken_promise_of_planes(mesh), "plane 0 has no face");
    mesh.face_plane.pop_back();
    EXPECT_EQ(broken_promise_of_planes(mesh), "11 labels for 12 faces");
    mesh = box({1, 1, 1}, 1);
    mesh.moments.pop_back();
    EXPECT_EQ(broken_promise_of_planes(mesh), "5 moments for 6 planes");
    mesh = box({1, 1, 1}, 1);
    mesh.vertex_class.pop_back();
    EXPECT_EQ(broken_promise_of_planes(mesh), "7 classes for 8 vertices");
}

TEST(Invariants, NameAPlaneInPieces)
{
    PlaneMesh mesh = box({1, 1, 1}, 4);
    mesh.face_plane[2 * 5] = mesh.face_plane[2 * 5 + 1] = mesh.face_plane[2 * 16]; // a cell of another plane
    EXPECT_EQ(broken_promise_of_planes(mesh), "1 planes are in pieces");
}

TEST(Invariants, OfLightMeshesNameWhatIsWrongWithFaces)
{
    PlaneMesh mesh = box({1, 1, 1}, 1);
    mesh.mesh.face.push_back(mesh.mesh.face[0]);
    mesh.face_plane.push_back(0);
    EXPECT_EQ(broken_promise_of_planes(mesh), "");
    EXPECT_EQ(broken_promise_of_light_mesh(mesh), "3 edges of three or more faces");
    mesh = box({1, 1, 1}, 1);
    mesh.mesh.position.push_back({2, 2, 2});
    mesh.vertex_class.push_back(VertexClass::Inner);
    EXPECT_EQ(broken_promise_of_light_mesh(mesh), "1 isolated vertices");
    mesh = box({1, 1, 1}, 1);
    mesh.plane[0] = mesh.plane[0].flipped();
    EXPECT_EQ(broken_promise_of_light_mesh(mesh), "2 faces that look away from their plane");
}

} // namespace
} // namespace quoin
