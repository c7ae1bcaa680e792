#include "partition/partition.h"

#include "base/parallel.h"
#include "geometry/pca_energy.h"
#include "mesh/adjacency.h"
#include "mesh/hygiene.h"
#include "mesh/invariants.h"
#include "partition/refine_borders.h"
#include "support/expect_error.h"
#include "support/grids.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace quoin {
namespace {

double energy_of(const PlaneMesh& mesh)
{
    double sum = 0.0;
    for (const auto& moments : mesh.moments)
        sum += pca_energy(moments, 1e-14);
    return sum;
}

PartitionParams clusters(int count, GrowthMethod method = GrowthMethod::Hybrid)
{
    PartitionParams params;
    params.clusters = count;
    params.method = method;
    return params;
}

constexpr GrowthMethod kMethods[] = {GrowthMethod::Heap, GrowthMethod::Hybrid, GrowthMethod::RegionGrowing};

void expect_valid(const TriangleMesh& mesh, const PlaneMesh& result)
{
    ASSERT_EQ(result.face_plane.size(), mesh.face.size());
    EXPECT_EQ(result.mesh.face, mesh.face);
    EXPECT_EQ(result.vertex_class.size(), mesh.position.size());
    EXPECT_EQ(result.moments.size(), result.plane.size());
    double area = 0.0, sum = 0.0;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        area += face_area(mesh, f);
    for (const auto& moments : result.moments)
        sum += moments.area;
    EXPECT_NEAR(sum, area, 1e-9 * area);
    for (const auto& plane : result.plane) {
        EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-9);
        EXPECT_TRUE(std::isfinite(plane.offset));
    }
    EXPECT_EQ(inspect(result).disconnected_planes, 0u);
    EXPECT_EQ(inspect(result).empty_planes, 0u);
}

TEST(Partition, OfTwoWallsAndAFloorAreTheirPlanes)
{
    const TriangleMesh mesh = test::room_corner(20, 0.002);
    for (const auto method : kMethods) {
        const PlaneMesh result = partition(mesh, clusters(3, method));
        expect_valid(mesh, result);
        ASSERT_EQ(result.plane.size(), 3u) << static_cast<int>(method);
        std::set<int> axes;
        for (const auto& plane : result.plane) {
            int axis = 0;
            EXPECT_GT(plane.normal.maxCoeff(&axis), std::cos(0.5 * std::numbers::pi / 180.0));
            EXPECT_NEAR(plane.offset, 0.0, 0.001);
            axes.insert(axis);
        }
        EXPECT_EQ(axes.size(), 3u);
    }
}

TEST(Partition, ByErrorFindsTheSamePlanesWithoutBeingToldTheirNumber)
{
    const TriangleMesh mesh = test::room_corner(20, 0.002);
    for (const auto method : kMethods) {
        PartitionParams params;
        params.method = method;
        const PlaneMesh result = partition(mesh, params);
        expect_valid(mesh, result);
        int large = 0;
        for (const auto& moments : result.moments) {
            EXPECT_LE(rms_to_fit(moments), params.max_error * (1 + 1e-9));
            large += moments.area > 0.8;
        }
        EXPECT_EQ(large, 3) << static_cast<int>(method);
    }
}

TEST(Partition, FlatAreasWhereAllCostsAreEqualEndInFewRounds)
{
    const TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 100, 100);
    const PlaneMesh result = partition(mesh, {});
    ASSERT_EQ(result.plane.size(), 1u);
    EXPECT_NEAR(result.plane[0].normal.z(), 1.0, 1e-12);
}

TEST(Partition, HybridEnergyIsWithinOnePercentOfTheExactGreedyOneOnAverage)
{
    double ratio = 0.0;
    const std::vector<unsigned> seeds{1, 2, 3, 4};
    for (const unsigned seed : seeds) {
        const TriangleMesh mesh = test::room_corner(40, 0.003, seed);
        PartitionParams exact = clusters(100, GrowthMethod::Heap), hybrid = clusters(100);
        exact.refine_rounds = hybrid.refine_rounds = 0;
        ratio += energy_of(partition(mesh, hybrid)) / energy_of(partition(mesh, exact));
    }
    EXPECT_LE(ratio / static_cast<double>(seeds.size()), 1.01);
}

TEST(Partition, RefinementLowersTheEnergyAndKeepsClustersConnected)
{
    const TriangleMesh mesh = test::room_corner(30, 0.003);
    PartitionParams raw = clusters(60), refined = clusters(60);
    raw.refine_rounds = 0;
    refined.border_distance = 0.0;
    const PlaneMesh before = partition(mesh, raw), after = partition(mesh, refined);
    expect_valid(mesh, after);
    EXPECT_EQ(after.plane.size(), before.plane.size());
    EXPECT_LT(energy_of(after), 0.98 * energy_of(before));
}

double border_length(const PlaneMesh& result)
{
    const auto opposite = opposite_half_edges(result.mesh);
    double length = 0.0;
    for (std::uint32_t h = 0; h < opposite.size(); ++h)
        if (opposite[h] < opposite.size() && result.face_plane[opposite[h] / 3] != result.face_plane[h / 3])
            length +=
                0.5 * (corner(result.mesh, h / 3, int((h + 1) % 3)) - corner(result.mesh, h / 3, int(h % 3))).norm();
    return length;
}

TEST(Partition, BordersAreStraighterWhenTheirLengthCosts)
{
    const TriangleMesh mesh = test::room_corner(30, 0.003);
    PartitionParams by_energy = clusters(20), weighted = clusters(20);
    by_energy.border_distance = 0.0;
    weighted.border_distance = 0.006;
    EXPECT_LT(border_length(partition(mesh, weighted)), border_length(partition(mesh, by_energy)));
}

TEST(RefineBorders, NeverRaisesEnergyPlusBorder)
{
    const TriangleMesh mesh = test::room_corner(20, 0.003);
    PartitionParams raw = clusters(25);
    raw.refine_rounds = 0;
    PlaneMesh result = partition(mesh, raw);
    const auto objective = [&] { // of the labels as they are
        std::fill(result.moments.begin(), result.moments.end(), Moments{});
        for (FaceId f = 0; f < mesh.face.size(); ++f)
            result.moments[result.face_plane[f]] +=
                triangle_moments(corner(mesh, f, 0), corner(mesh, f, 1), corner(mesh, f, 2));
        return energy_of(result) + border_weight(mesh, 0.003) * border_length(result);
    };
    double before = objective();
    for (const double rounds : {0.5, 1.0, 2.0, 4.0}) {
        refine_borders(mesh, opposite_half_edges(mesh),
                       {rounds, 0.003, std::numeric_limits<double>::infinity(), 0.0, 1e-14}, result.face_plane);
        const double after = objective();
        EXPECT_LE(after, before * (1 + 1e-9));
        EXPECT_EQ(inspect(result).disconnected_planes, 0u);
        before = after;
    }
}

TEST(Partition, PlanesIgnoreTheBumpsThatLeastSquaresFollows)
{
    const auto bump = [](double x, double y) { return x > 0.7 && y > 0.7 ? 0.03 : 0.0; };
    const TriangleMesh mesh = test::height_field(40, bump);
    PartitionParams params = clusters(1);
    const PlaneMesh robust = partition(mesh, params);
    params.robust_rounds = 0;
    const PlaneMesh least_squares = partition(mesh, params);
    EXPECT_GT(robust.plane[0].normal.z(), 1.0 - 1e-9);
    EXPECT_NEAR(robust.plane[0].offset, 0.0, 1e-6);
    EXPECT_LT(least_squares.plane[0].normal.z(), 1.0 - 1e-5);
}

TEST(Partition, KeepsTheTwoSidesOfAThinSheetApart)
{
    TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20);
    TriangleMesh back = test::grid({0, 0, -0.006}, {0, 1, 0}, {1, 0, 0}, 20, 20);
    const auto offset = static_cast<VertexId>(mesh.position.size());
    test::append(mesh, back);
    for (VertexId i = 0; i < 20; ++i) { // closes the edge y = 0: front vertices i, back vertices 21 i
        const VertexId a = i, b = i + 1, c = offset + 21 * i, d = offset + 21 * (i + 1);
        mesh.face.push_back({a, c, b});
        mesh.face.push_back({b, c, d});
    }
    const PlaneMesh result = partition(mesh, {});
    expect_valid(mesh, result);
    EXPECT_NE(result.face_plane[0], result.face_plane[900]);
    EXPECT_GT(result.plane[result.face_plane[0]].normal.z(), 0.99);
    EXPECT_LT(result.plane[result.face_plane[900]].normal.z(), -0.99);
}

TEST(Partition, FarFromTheOriginIsTheSame)
{
    const TriangleMesh near_mesh = test::room_corner(16, 0.002);
    TriangleMesh far_mesh = near_mesh;
    for (auto& p : far_mesh.position)
        p += Eigen::Vector3f(64, -32, 16);
    EXPECT_EQ(partition(far_mesh, clusters(3)).plane.size(), 3u);
    const auto near_result = partition(near_mesh, clusters(3)), far_result = partition(far_mesh, clusters(3));
    std::size_t same = 0;
    for (FaceId f = 0; f < near_mesh.face.size(); ++f)
        same += near_result.face_plane[f] == far_result.face_plane[f];
    EXPECT_GT(same, near_mesh.face.size() * 99 / 100);
}

TEST(Partition, HasTheSameBytesForAnyNumberOfThreads)
{
    const TriangleMesh mesh = test::room_corner(60, 0.003);
    for (const auto method : kMethods) {
        set_thread_count(1);
        PartitionParams params;
        params.method = method;
        params.max_error = 0.004;
        const PlaneMesh one = partition(mesh, params);
        for (const int threads : {2, 4}) {
            set_thread_count(threads);
            const PlaneMesh many = partition(mesh, params);
            EXPECT_EQ(one.face_plane, many.face_plane);
            for (std::size_t p = 0; p < one.plane.size(); ++p) {
                EXPECT_EQ(one.plane[p].normal, many.plane[p].normal);
                EXPECT_EQ(one.plane[p].offset, many.plane[p].offset);
            }
        }
        set_thread_count(0);
    }
}

// Degenerate input.

TEST(Partition, OfAnEmptyMeshIsImpossible)
{
    EXPECT_NE(test::error_of([] { partition({}, {}); }, ExitCode::Impossible).find("0 faces"), std::string::npos);
}

TEST(Partition, OfFacesWithoutAreaIsImpossible)
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.face = {{0, 1, 2}, {0, 0, 0}};
    test::error_of([&] { partition(mesh, {}); }, ExitCode::Impossible);
}

TEST(Partition, NamesTheFaceAndVertexThatIsNotFinite)
{
    TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2);
    mesh.position[4].y() = std::numeric_limits<float>::quiet_NaN();
    const std::string message = test::error_of([&] { partition(mesh, {}); }, ExitCode::Input);
    EXPECT_NE(message.find("face 0 uses vertex 4"), std::string::npos) << message;
}

TEST(Partition, NamesTheFaceWhoseVertexDoesNotExist)
{
    TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2);
    mesh.face[3][1] = 77;
    const std::string message = test::error_of([&] { partition(mesh, {}); }, ExitCode::Input);
    EXPECT_NE(message.find("face 3 uses vertex 77"), std::string::npos) << message;
}

TEST(Partition, OfOneFaceIsOnePlane)
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face = {{0, 2, 1}};
    for (const auto method : kMethods) {
        const PlaneMesh result = partition(mesh, clusters(0, method));
        expect_valid(mesh, result);
        ASSERT_EQ(result.plane.size(), 1u);
        EXPECT_NEAR(result.plane[0].normal.z(), -1.0, 1e-12);
    }
}

TEST(Partition, WithMoreClustersAskedForThanFacesIsOnePlaneAFace)
{
    TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 5, 1);
    for (const auto method : {GrowthMethod::Heap, GrowthMethod::Hybrid})
        for (const int count : {10, 1000}) {
            const PlaneMesh result = partition(mesh, clusters(count, method));
            expect_valid(mesh, result);
            EXPECT_EQ(result.plane.size(), 10u);
        }
}

TEST(Partition, SurvivesDegenerateAndDuplicateFaces)
{
    TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 10, 10, 0.001);
    mesh.face.push_back(mesh.face[7]);                                        // the same again
    mesh.face.push_back({mesh.face[9][1], mesh.face[9][0], mesh.face[9][2]}); // turned over
    mesh.face.push_back({3, 3, 4});                                           // two corners in one
    mesh.face.push_back({5, 5, 5});                                           // all in one
    mesh.position.push_back(mesh.position[0]);
    mesh.face.push_back({0, static_cast<VertexId>(mesh.position.size() - 1), 1}); // no area
    for (const auto method : kMethods) {
        const PlaneMesh result = partition(mesh, clusters(0, method));
        ASSERT_EQ(result.face_plane.size(), mesh.face.size());
        EXPECT_EQ(broken_promise_of_planes(result), "");
        EXPECT_EQ(result.face_plane[7], result.face_plane[200]) << "a duplicate lies in the cluster of its twin";
        for (const auto& plane : result.plane)
            EXPECT_TRUE(plane.normal.allFinite() && std::isfinite(plane.offset));
    }
}

TEST(Partition, OfASphereByErrorIsManyCaps)
{
    const TriangleMesh mesh = test::sphere(4, 0.5);
    const PlaneMesh result = partition(mesh, {});
    expect_valid(mesh, result);
    EXPECT_GT(result.plane.size(), 8u);
    for (const auto& moments : result.moments)
        EXPECT_LE(rms_to_fit(moments), 0.008 * (1 + 1e-9));
    for (std::size_t p = 0; p < result.plane.size(); ++p)
        EXPECT_GT(result.plane[p].normal.dot(result.moments[p].centroid()), 0.0)
            << "normals face outwards, as the faces do";
}

TEST(Partition, OfASphereIntoOneClusterStopsWhereFacesWouldCancel)
{
    const TriangleMesh mesh = test::sphere(3, 0.5);
    EXPECT_GT(partition(mesh, clusters(1)).plane.size(), 1u);
    PartitionParams params = clusters(1);
    params.min_facing = 0.0;
    EXPECT_EQ(partition(mesh, params).plane.size(), 1u);
}

TEST(Partition, ASmallThingOnALargeWallKeepsItsOwnPlanes)
{
    // 6 cm x 6 cm, 3 cm high, on 1 m^2: it raises the wall's RMS distance by less than max_error allows.
    const auto on_thing = [](double x, double y) { return std::abs(x - 0.5) < 0.03 && std::abs(y - 0.5) < 0.03; };
    const TriangleMesh mesh = test::height_field(100, [&](double x, double y) { return on_thing(x, y) ? 0.03 : 0.0; });
    const PlaneMesh result = partition(mesh, {});
    expect_valid(mesh, result);
    ASSERT_LT(std::sqrt(0.0036) * 0.03, PartitionParams{}.max_error);
    std::set<PlaneId> top, wall;
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        const Eigen::Vector3d c = (corner(mesh, f, 0) + corner(mesh, f, 1) + corner(mesh, f, 2)) / 3.0;
        if (c.z() > 0.029) top.insert(result.face_plane[f]);
        if (c.z() < 0.001) wall.insert(result.face_plane[f]);
    }
    EXPECT_EQ(wall.size(), 1u);
    EXPECT_EQ(top.count(*wall.begin()), 0u);
}

TEST(Partition, FloatersDoNotUseUpTheClusters)
{
    TriangleMesh mesh = test::room_corner(16, 0.001);
    for (int i = 0; i < 50; ++i)
        test::append(mesh, test::grid({2.0 + 0.1 * i, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, 1, 1));
    const PlaneMesh result = partition(mesh, clusters(3));
    expect_valid(mesh, result);
    EXPECT_EQ(result.plane.size(), 53u);
}

} // namespace
} // namespace quoin
