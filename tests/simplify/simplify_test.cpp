#include "simplify/simplify.h"

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/hygiene.h"
#include "mesh/invariants.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>
#include <limits>
#include <random>

namespace quoin {
namespace {

using namespace testing_support;

bool is_clean(const PlaneMesh& mesh)
{
    const auto found = inspect(mesh);
    return found.non_manifold_edges + found.duplicate_faces + found.bow_tie_vertices + found.folded_pairs +
               found.zero_area_faces + found.inconsistent_edges + found.isolated_vertices + found.flipped_faces +
               found.disconnected_planes + found.empty_planes ==
           0;
}

// Largest distance of a vertex to the planes of its faces [m].
double largest_distance_to_planes(const PlaneMesh& mesh)
{
    double largest = 0.0;
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f)
        for (int k = 0; k < 3; ++k)
            largest =
                std::max(largest, std::abs(mesh.plane[mesh.face_plane[f]].signed_distance(corner(mesh.mesh, f, k))));
    return largest;
}

TEST(Simplify, LeavesTwelveFacesOfABox)
{
    const auto result = simplify(box({1, 2, 3}, 20), {});
    EXPECT_EQ(result.mesh.face.size(), 12u);
    EXPECT_TRUE(is_clean(result));
    EXPECT_EQ(inspect(result).euler_characteristic, 2);
}

TEST(Simplify, OfANoisyBoxKeepsFewFacesClosedOnItsPlanes)
{
    const auto noisy = with_noise(box({2, 2, 2}, 40), 0.004f);
    const auto result = simplify(noisy, {});
    EXPECT_LT(result.mesh.face.size(), noisy.mesh.face.size() / 50);
    EXPECT_TRUE(is_clean(result));
    EXPECT_EQ(inspect(result).euler_characteristic, 2);
    EXPECT_LT(largest_distance_to_planes(result), 0.001);
}

TEST(Simplify, KeepsPlanesAndMoments)
{
    const auto input = box({1, 1, 1}, 5);
    const auto result = simplify(input, {});
    ASSERT_EQ(result.plane.size(), 6u);
    for (PlaneId p = 0; p < 6; ++p) {
        EXPECT_EQ(result.plane[p].normal, input.plane[p].normal);
        EXPECT_EQ(result.moments[p].area, input.moments[p].area);
    }
}

TEST(Simplify, OfARoomCornerKeepsTheCornerAndTheCreases)
{
    const auto result = simplify(with_noise(room_corner(30), 0.003f), {});
    EXPECT_TRUE(is_clean(result));
    EXPECT_LT(result.mesh.face.size(), 5400u / 50);
    EXPECT_EQ(inspect(result).euler_characteristic, 1);
    float nearest = 1.0f;
    for (const auto& p : result.mesh.position)
        nearest = std::min(nearest, p.norm());
    EXPECT_LT(nearest, 1e-5f);
}

TEST(Simplify, StraightensASawtoothCrease)
{
    // Every second cell along the crease is labelled with the plane of the other side.
    auto mesh = l_corner(40);
    for (FaceId f = 0; f < 80; f += 4)
        mesh.face_plane[f] = 1;
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    const auto result = simplify(mesh, {});
    EXPECT_TRUE(is_clean(result));
    EXPECT_LE(result.mesh.face.size(), 8u);
    EXPECT_LT(largest_distance_to_planes(result), 0.001);
}

TEST(Simplify, MovesAMeshBorderByNoMoreThanTheError)
{
    auto mesh = l_corner(50);
    for (auto& p : mesh.mesh.position) // a wavy border at y = 1
        p.y() *= 1.0f + 0.03f * std::sin(12.0f * p.x());
    SimplifyParams params;
    params.max_open_error = 0.002;
    const auto result = simplify(mesh, params);
    EXPECT_TRUE(is_clean(result));
    EXPECT_NEAR(inspect(result).border_length, inspect(mesh).border_length, 0.02);
    params.max_open_error = 0.2;
    EXPECT_LT(simplify(mesh, params).mesh.face.size(), result.mesh.face.size());
}

// A square of 1 m whose cells from `first` to `last` both ways are of a plane of their own, as it lies.
PlaneMesh square_with_an_island(int cells, int first, int last)
{
    auto mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, cells}});
    mesh.plane.push_back(mesh.plane[0]);
    mesh.moments.push_back(mesh.moments[0]);
    for (int j = first; j < last; ++j)
        for (int i = first; i < last; ++i)
            for (int half = 0; half < 2; ++half)
                mesh.face_plane[static_cast<std::size_t>(2 * (cells * j + i) + half)] = 1;
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    return mesh;
}

TEST(Simplify, KeepsAnIslandInsideAPlane)
{
    const auto result = simplify(square_with_an_island(30, 10, 20), {});
    ASSERT_EQ(result.plane.size(), 2u);
    EXPECT_TRUE(is_clean(result));
    double island = 0.0;
    for (FaceId f = 0; f < result.mesh.face.size(); ++f)
        if (result.face_plane[f] == 1) island += face_area(result.mesh, f);
    EXPECT_NEAR(island, 1.0 / 9.0, 0.02);
    EXPECT_LT(result.mesh.face.size(), 40u);
}

TEST(Simplify, TakesAnIslandTooSmallToTellIntoThePlaneAroundIt)
{
    const auto result = simplify(square_with_an_island(100, 50, 52), {});
    EXPECT_EQ(result.plane.size(), 1u);
    EXPECT_EQ(result.mesh.face.size(), 2u);
}

TEST(Simplify, KeepsASmallIslandThatStandsOut)
{
    auto mesh = square_with_an_island(100, 50, 52);
    mesh.mesh.position[51 * 101 + 51].z() = 0.03f; // its middle
    const auto result = simplify(mesh, {});
    EXPECT_EQ(result.plane.size(), 2u);
    EXPECT_TRUE(is_clean(result));
}

// A square of 1 cm cells with a tab on one side that is turned over along its length: seen along the normal, the border
// of this one plane crosses itself.
PlaneMesh square_with_a_twisted_tab(int cells)
{
    constexpr int kWidth = 4, kLength = 12; // [cells]
    constexpr double kCell = 0.01;
    auto result = join_sheets({{{0, 0, 0}, {kCell * cells, 0, 0}, {0, kCell * cells, 0}, cells}});
    TriangleMesh& mesh = result.mesh;
    const double middle = kCell * (cells / 2);
    const auto at = [&](int i, int j) -> Eigen::Vector3f { // across, along
        const double across = kCell * (i - 0.5 * kWidth), turn = M_PI * j / kLength;
        return Eigen::Vector3d(middle + across * std::cos(turn), -kCell * j, across * std::sin(turn)).cast<float>();
    };
    const auto nearest = [&](const Eigen::Vector3f& p) {
        const auto found = std::ranges::min_element(mesh.position, {}, [&](const auto& q) { return (q - p).norm(); });
        return static_cast<VertexId>(found - mesh.position.begin());
    };
    std::vector<VertexId> row;
    for (int i = 0; i <= kWidth; ++i)
        row.push_back(nearest(at(i, 0)));
    for (int j = 1; j <= kLength; ++j) {
        const auto first = static_cast<VertexId>(mesh.position.size());
        for (VertexId i = 0; i <= kWidth; ++i)
            mesh.position.push_back(at(static_cast<int>(i), j));
        for (VertexId i = 0; i < kWidth; ++i) {
            mesh.face.push_back({first + i, first + i + 1, row[i]});
            mesh.face.push_back({first + i + 1, row[i + 1], row[i]});
        }
        for (VertexId i = 0; i <= kWidth; ++i)
            row[i] = first + i;
    }
    result.face_plane.assign(mesh.face.size(), 0);
    result.vertex_class = classify_vertices(mesh, result.face_plane);
    return result;
}

TEST(Simplify, CutsAKnotOutOfAPlaneAndFillsTheRest)
{
    const auto knotted = square_with_a_twisted_tab(60);
    const auto result = simplify(knotted, {});
    const auto found = inspect(result);
    EXPECT_EQ(found.euler_characteristic, 1);
    EXPECT_EQ(found.non_manifold_edges + found.bow_tie_vertices + found.flipped_faces + found.folded_pairs, 0u);
    std::size_t on_square = 0; // with a corner on it, away from the tab
    for (const Face& face : result.mesh.face)
        for (const VertexId v : face)
            if (result.mesh.position[v].y() > 0.1f) {
                ++on_square;
                break;
            }
    EXPECT_LE(on_square, 12u);
    SimplifyParams qem;
    qem.method = SimplifyMethod::Qem;
    EXPECT_LT(result.mesh.face.size(), simplify(knotted, qem).mesh.face.size() + 20);
}

// A floor of 6 mm cells, some rows of them with ragged islands and holes a few cells large. The islands of a row belong
// to a plane that is tilted about the row: most of their border is within reach of its line in the floor.
PlaneMesh floor_with_tilted_islands(unsigned seed)
{
    constexpr int kCells = 60, kFirstRow = 6, kRowStep = 12, kSteps = 8;
    constexpr double kCell = 0.006, kTilt = 0.5;
    std::mt19937 random(seed);
    const auto number = [&] { return static_cast<double>(random()) / std::mt19937::max(); };
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(1.0, number() - 0.5, number() - 0.5, number() - 0.5).normalized();
    const Eigen::Vector3d origin(number(), number(), 3.0),
        x = turn * Eigen::Vector3d::UnitX(), y = turn * Eigen::Vector3d::UnitY(), z = turn * Eigen::Vector3d::UnitZ();
    auto mesh = join_sheets({{origin, kCell * kCells * x, kCell * kCells * y, kCells}});
    const auto face = [](int i, int j, unsigned half) { return static_cast<FaceId>(2 * (kCells * j + i)) + half; };
    for (int row = kFirstRow; row < kCells; row += kRowStep) {
        const Eigen::Vector3d normal = std::cos(kTilt) * z - std::sin(kTilt) * y;
        mesh.plane.push_back({normal, -normal.dot(origin + kCell * row * y)});
        mesh.moments.push_back(mesh.moments[0]);
        for (int middle = 5; middle < kCells; middle += 10)
            for (int step = 0, i = middle, j = row; step < kSteps; ++step) { // a random walk
                mesh.face_plane[face(i, j, random() % 2)] = static_cast<PlaneId>(mesh.plane.size() - 1);
                (random() % 2 == 0 ? i : j) += random() % 2 == 0 ? 1 : -1;
                i = std::clamp(i, middle - 3, middle + 3);
                j = std::clamp(j, row - 2, row + 2);
            }
    }
    PlaneMesh result = mesh;
    result.mesh.face.clear();
    result.face_plane.clear();
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        const int row = static_cast<int>(f) / (2 * kCells);
        if ((row + kRowStep - kFirstRow) % kRowStep < 2 && random() % 8 == 0) continue;
        result.mesh.face.push_back(mesh.mesh.face[f]);
        result.face_plane.push_back(mesh.face_plane[f]);
    }
    result.vertex_class = classify_vertices(result.mesh, result.face_plane);
    return result;
}

TEST(Simplify, LeavesRoomForFacesBetweenBordersThatCouldLieOnOneLine)
{
    for (unsigned seed = 0; seed < 60; ++seed) {
        const auto result = simplify(floor_with_tilted_islands(seed), {});
        EXPECT_EQ(inspect(result).zero_area_faces, 0u) << seed;
        EXPECT_EQ(broken_promise_of_light_mesh(result), "") << seed;
    }
}

TEST(Simplify, KeepsAtLeastFourFacesOfAClosedSurfaceOfOnePlane)
{
    auto mesh = box({0.01, 0.01, 0.01}, 6);
    std::fill(mesh.face_plane.begin(), mesh.face_plane.end(), 0u);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    const auto result = simplify(mesh, {});
    EXPECT_EQ(inspect(result).flipped_faces, 0u) << "the back is a plane of its own";
    EXPECT_GE(result.mesh.face.size(), 4u);
    EXPECT_EQ(inspect(result).euler_characteristic, 2);
    EXPECT_EQ(inspect(result).non_manifold_edges + inspect(result).duplicate_faces, 0u);
}

TEST(Simplify, KeepsAStripWithoutInnerVertices)
{
    const auto mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}, 1}, {{0, 0.1, 0}, {1, 0, 0}, {0, 0, 1}, 1}});
    EXPECT_EQ(simplify(mesh, {}).mesh.face.size(), 4u);
}

TEST(Simplify, SplitsAnEdgeOfThreeFaces)
{
    // A third wall hangs on the crease.
    const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0);
    const auto mesh = join_sheets({{o, x, {0, 1, 0}, 12}, {o, {0, 0, 1}, x, 12}, {o, x, {0, -1, -1}, 12}});
    ASSERT_GT(inspect(mesh).non_manifold_edges, 0u);
    const auto result = simplify(mesh, {});
    EXPECT_EQ(inspect(result).non_manifold_edges + inspect(result).bow_tie_vertices, 0u);
    EXPECT_LT(result.mesh.face.size(), mesh.mesh.face.size() / 5);
}

TEST(Simplify, DropsBrokenFacesAndPlanesWithoutAny)
{
    auto mesh = l_corner(4);
    mesh.mesh.position.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
    const auto broken = static_cast<VertexId>(mesh.mesh.position.size() - 1);
    mesh.plane.insert(mesh.plane.begin(), Plane{});
    mesh.moments.insert(mesh.moments.begin(), Moments{});
    for (auto& p : mesh.face_plane)
        ++p;
    mesh.mesh.face.push_back({0, 1, broken});
    mesh.mesh.face.push_back({0, 0, 1});
    mesh.mesh.face.push_back(mesh.mesh.face[0]);
    mesh.face_plane.insert(mesh.face_plane.end(), 3, 0u);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    const auto result = simplify(mesh, {});
    EXPECT_EQ(result.plane.size(), 2u);
    EXPECT_EQ(result.mesh.face.size(), 4u);
    EXPECT_TRUE(is_clean(result));
}

TEST(Simplify, OfAMeshWithoutFacesIsImpossible) { EXPECT_THROW(simplify(PlaneMesh{}, {}), ImpossibleError); }

TEST(Simplify, WeldsVerticesAtOnePlace)
{
    const auto whole = l_corner(10);
    PlaneMesh soup = whole;
    soup.mesh.position.clear();
    for (auto& face : soup.mesh.face)
        for (auto& v : face) {
            soup.mesh.position.push_back(whole.mesh.position[v]);
            v = static_cast<VertexId>(soup.mesh.position.size() - 1);
        }
    soup.vertex_class = classify_vertices(soup.mesh, soup.face_plane);
    EXPECT_EQ(simplify(soup, {}).mesh.face.size(), 4u);
}

TEST(Simplify, MeetsAFaceBudget)
{
    SimplifyParams params;
    params.max_error = 1e-4;
    params.snap_distance = 0.0;
    const auto noisy = with_noise(box({2, 2, 2}, 20), 0.004f);
    ASSERT_GT(simplify(noisy, params).mesh.face.size(), 200u);
    params.face_budget = 200;
    const auto result = simplify(noisy, params);
    EXPECT_LE(result.mesh.face.size(), 200u);
    const auto found = inspect(result);
    EXPECT_EQ(found.euler_characteristic, 2);
    EXPECT_EQ(found.non_manifold_edges + found.bow_tie_vertices + found.duplicate_faces + found.flipped_faces, 0u);
}

TEST(Simplify, ByRemeshingNeedsNoMoreFacesThanByQuadricsAndNoneLooksAway)
{
    SimplifyParams params;
    params.method = SimplifyMethod::Remesh;
    for (unsigned seed = 0; seed < 4; ++seed) {
        const auto noisy = with_noise(room_corner(30), 0.004f, seed);
        const auto remeshed = simplify(noisy, params);
        params.method = SimplifyMethod::Qem;
        const auto contracted = simplify(noisy, params);
        params.method = SimplifyMethod::Remesh;
        EXPECT_TRUE(is_clean(remeshed)) << seed;
        EXPECT_LE(remeshed.mesh.face.size(), contracted.mesh.face.size()) << seed;
        EXPECT_LT(largest_distance_to_planes(remeshed), 0.001) << seed;
    }
}

TEST(Simplify, FillsAHoleSmallerThanTheErrorOfOpenBordersAndNoLargerOne)
{
    const auto with_hole = [](double radius) {
        auto mesh = join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 100}});
        std::vector<Face> kept;
        for (const auto& face : mesh.mesh.face)
            if ((mesh.mesh.position[face[0]].head<2>() - Eigen::Vector2f(0.5f, 0.5f)).norm() > radius)
                kept.push_back(face);
        mesh.mesh.face = kept;
        mesh.face_plane.resize(kept.size());
        mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
        return mesh;
    };
    EXPECT_EQ(inspect(simplify(with_hole(0.012), {})).euler_characteristic, 1);
    EXPECT_EQ(inspect(simplify(with_hole(0.1), {})).euler_characteristic, 0);
}

TEST(Simplify, KeepsTheFractionsAskedFor)
{
    SimplifyParams params;
    params.method = SimplifyMethod::Qem;
    params.inner_ratio = 0.5;
    params.border_ratio = 1.0;
    const auto mesh = l_corner(20);
    const auto result = simplify(mesh, params);
    const auto inner = [](const PlaneMesh& m) {
        return std::count(m.vertex_class.begin(), m.vertex_class.end(), VertexClass::Inner);
    };
    EXPECT_GE(inner(result), inner(mesh) / 4);
    EXPECT_EQ(inspect(result).border_edges, inspect(mesh).border_edges);
}

TEST(Simplify, GivesTheSameBytesForAnyNumberOfThreads)
{
    const auto noisy = with_noise(box({2, 2, 2}, 30), 0.01f);
    set_thread_count(1);
    const auto one = simplify(noisy, {});
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        const auto many = simplify(noisy, {});
        EXPECT_EQ(one.mesh.face, many.mesh.face);
        EXPECT_EQ(one.face_plane, many.face_plane);
        EXPECT_TRUE(one.mesh.position == many.mesh.position);
    }
    set_thread_count(0);
}

TEST(Simplify, NeverWorsensAMeshOfRandomLabels)
{
    for (unsigned seed = 0; seed < 8; ++seed) {
        auto mesh = with_noise(box({1, 1, 1}, 10), 0.02f, seed);
        std::mt19937 random(seed);
        for (auto& p : mesh.face_plane)
            if (random() % 4 == 0) p = random() % 6;
        mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
        const auto result = simplify(mesh, {});
        EXPECT_EQ(broken_promise_of_light_mesh(result), "") << seed;
        const auto before = inspect(mesh), after = inspect(result);
        EXPECT_EQ(after.euler_characteristic, 2) << seed;
        EXPECT_EQ(after.inconsistent_edges, 0u) << seed;
        EXPECT_LE(after.flipped_faces, before.flipped_faces) << seed;
        EXPECT_LE(after.folded_pairs, before.folded_pairs + 3)
            << seed; // over borders, where faces look away from their planes
    }
}

} // namespace
} // namespace quoin
