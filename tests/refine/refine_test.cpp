#include "refine/refine.h"

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/hygiene.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>
#include <limits>

namespace quoin {
namespace {

using namespace testing_support;

double largest_distance_to_planes(const PlaneMesh& mesh)
{
    double largest = 0.0;
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f)
        for (int k = 0; k < 3; ++k)
            largest =
                std::max(largest, std::abs(mesh.plane[mesh.face_plane[f]].signed_distance(corner(mesh.mesh, f, k))));
    return largest;
}

double largest_move(const PlaneMesh& a, const PlaneMesh& b)
{
    double largest = 0.0;
    for (std::size_t v = 0; v < a.mesh.position.size(); ++v)
        largest = std::max(largest, double((a.mesh.position[v] - b.mesh.position[v]).norm()));
    return largest;
}

// A box whose edges are cut off by pulling border vertices inwards.
PlaneMesh rounded_box(double depth)
{
    auto mesh = box({1, 1, 1}, 8);
    const Eigen::Vector3f middle(0.5f, 0.5f, 0.5f);
    for (VertexId v = 0; v < mesh.mesh.position.size(); ++v)
        if (mesh.vertex_class[v] != VertexClass::Inner)
            mesh.mesh.position[v] += float(depth) * (middle - mesh.mesh.position[v]).normalized();
    return mesh;
}

TEST(FaceMass, IsTheSumOverTexelsOfTheirBarycentricProducts)
{
    // Centres of n^2 equal small triangles, exact in the limit.
    constexpr int n = 200;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const auto add = [&](double b1, double b2) {
        const Eigen::Vector3d b(b1, b2, 1.0 - b1 - b2);
        sum += b * b.transpose();
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            add((i + 1.0 / 3.0) / n, (j + 1.0 / 3.0) / n);
            if (i + j + 1 < n) add((i + 2.0 / 3.0) / n, (j + 2.0 / 3.0) / n);
        }
    EXPECT_LT((sum - face_mass(n * n)).norm() / sum.norm(), 1e-4);
}

TEST(OptimizeGeometry, LeavesAMeshOnItsPlanesWhereItIs)
{
    const auto mesh = box({1, 1, 1}, 6);
    EXPECT_LT(largest_move(optimize_geometry(mesh, mesh.plane, {}), mesh), 1e-6);
}

TEST(OptimizeGeometry, RestoresTheCreasesOfARoundedBox)
{
    const auto rounded = rounded_box(0.02);
    const auto result = optimize_geometry(rounded, rounded.plane, {});
    EXPECT_GT(largest_distance_to_planes(rounded), 0.01);
    EXPECT_LT(largest_distance_to_planes(result), 5e-4);
    EXPECT_EQ(inspect(result).flipped_faces, 0u);
    EXPECT_EQ(inspect(result).folded_pairs, 0u);
}

// A flap on the edge of the box is steep to its plane, which turns by 20 degrees.
TEST(OptimizeGeometry, GivesFacesAnotherPlaneThatTheirsTurnedAwayFrom)
{
    auto mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 8}, {{0, 1, 0}, {1, 0, 0}, {0, 0.003, -0.03}, 8}});
    std::ranges::fill(mesh.face_plane, 0u);
    mesh.plane.pop_back();
    mesh.moments.pop_back();
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    ASSERT_EQ(inspect(mesh).flipped_faces, 0u);
    const Eigen::Vector3d turned = Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ();
    const auto result = optimize_geometry(mesh, {{turned, -turned.dot(Eigen::Vector3d(0.5, 0.5, 0.0))}}, {});
    EXPECT_EQ(inspect(result).flipped_faces, 0u);
    EXPECT_EQ(inspect(result).disconnected_planes, 0u);
    EXPECT_EQ(result.plane.size(), 2u);
    EXPECT_EQ(result.plane.size(), result.moments.size());
}

TEST(OptimizeGeometry, FlattensANoisyBoxWithoutFlips)
{
    const auto noisy = with_noise(box({1, 1, 1}, 10), 0.01f);
    const auto result = optimize_geometry(noisy, noisy.plane, {});
    EXPECT_LT(largest_distance_to_planes(result), 1e-3);
    EXPECT_EQ(inspect(result).flipped_faces, 0u);
}

TEST(OptimizeGeometry, FollowsMovedPlanes)
{
    const auto mesh = box({1, 1, 1}, 6);
    auto planes = mesh.plane;
    planes[1].offset -= 0.01; // the lid rises
    planes[2] = planes[2].flipped();
    const auto result = optimize_geometry(mesh, planes, {});
    EXPECT_LT(largest_distance_to_planes(result), 2e-4);
    EXPECT_EQ(result.plane[1].offset, planes[1].offset);
    EXPECT_EQ(result.plane[2].normal, mesh.plane[2].normal);
}

TEST(OptimizeGeometry, GivesTheSameByCholeskyAndPcg)
{
    const auto noisy = with_noise(room_corner(12), 0.01f);
    OptimizeGeometryParams params;
    const auto exact = optimize_geometry(noisy, noisy.plane, params);
    params.solver = LinearSolver::Pcg;
    EXPECT_LT(largest_move(optimize_geometry(noisy, noisy.plane, params), exact), 1e-6);
}

TEST(OptimizeGeometry, WithThePapersRegularizerRoundsCreasesMore)
{
    const auto rounded = rounded_box(0.02);
    OptimizeGeometryParams paper;
    paper.regularizer = Regularizer::Laplacian;
    paper.lambda_l = 0.0;
    paper.iterations = 1;
    const auto ours = optimize_geometry(rounded, rounded.plane, {});
    const auto theirs = optimize_geometry(rounded, rounded.plane, paper);
    EXPECT_GT(largest_distance_to_planes(theirs), 5.0 * largest_distance_to_planes(ours));
}

TEST(OptimizeGeometry, MovesNoVertexFartherThanAllowed)
{
    const auto rounded = rounded_box(0.05);
    OptimizeGeometryParams params;
    params.max_move = 0.01;
    EXPECT_LT(largest_move(optimize_geometry(rounded, rounded.plane, params), rounded), 0.01 + 1e-6);
}

TEST(OptimizeGeometry, DoesNotSendVerticesToWhereNearlyParallelPlanesMeet)
{
    // Two halves of a wall, 5 mm apart at the seam and 2 degrees different: they meet 14 cm away.
    auto mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 8}, {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 8}});
    const Eigen::Vector3d tilted(std::sin(0.035), 0, std::cos(0.035));
    mesh.plane[1] = {tilted, -tilted.dot(Eigen::Vector3d(1, 0, 0.005))};
    const auto result = optimize_geometry(mesh, mesh.plane, {});
    EXPECT_LT(largest_move(result, mesh), 0.045);
}

TEST(OptimizeGeometry, KeepsTheShapeOfWhatNoPlaneExplains)
{
    auto mesh = with_noise(join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 8}}), 0.01f);
    const auto flat = optimize_geometry(mesh, mesh.plane, {});
    mesh.moments[0].second[5] = mesh.moments[0].area * 0.1 * 0.1; // RMS 10 cm
    const auto shaped = optimize_geometry(mesh, mesh.plane, {});
    EXPECT_LT(largest_distance_to_planes(flat), 0.1 * largest_distance_to_planes(mesh));
    EXPECT_GT(largest_distance_to_planes(shaped), 0.5 * largest_distance_to_planes(mesh));
}

TEST(OptimizeGeometry, BearsASingleFaceAFlatFaceAndAVertexWithoutFaces)
{
    PlaneMesh mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1}});
    mesh.mesh.position.emplace_back(0.5f, 0.5f, 0.0f);
    mesh.mesh.position.emplace_back(5.0f, 5.0f, 5.0f);
    mesh.mesh.face.push_back({0, 2, 4});
    mesh.face_plane.push_back(0);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    const auto result = optimize_geometry(mesh, mesh.plane, {});
    for (const auto& p : result.mesh.position)
        EXPECT_TRUE(p.allFinite());
    EXPECT_LT((result.mesh.position[5] - mesh.mesh.position[5]).norm(), 1e-5f);
}

TEST(OptimizeGeometry, RefusesOtherPlanesThanThoseOfTheMesh)
{
    const auto mesh = box({1, 1, 1}, 1);
    EXPECT_THROW(optimize_geometry(mesh, {}, {}), InputError);
    auto planes = mesh.plane;
    planes[3].offset = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(optimize_geometry(mesh, planes, {}), InputError);
}

TEST(OptimizeGeometry, OfNothingIsNothing) { EXPECT_TRUE(optimize_geometry(PlaneMesh{}, {}, {}).mesh.face.empty()); }

TEST(OptimizeGeometry, GivesTheSameBytesForAnyNumberOfThreads)
{
    const auto noisy = with_noise(box({1, 1, 1}, 12), 0.01f);
    set_thread_count(1);
    const auto one = optimize_geometry(noisy, noisy.plane, {});
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        EXPECT_TRUE(optimize_geometry(noisy, noisy.plane, {}).mesh.position == one.mesh.position);
    }
    set_thread_count(0);
}

} // namespace
} // namespace quoin
