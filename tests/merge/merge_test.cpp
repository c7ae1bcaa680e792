#include "merge/merge.h"

#include "base/parallel.h"
#include "mesh/hygiene.h"
#include "mesh/plane_fit.h"
#include "partition/partition.h"
#include "support/expect_error.h"
#include "support/grids.h"

#include <gtest/gtest.h>

#include <set>

namespace quoin {
namespace {

// The clusters that label(x, y, z) of the faces' centroids tells apart.
template <class Label>
PlaneMesh clustered(const TriangleMesh& mesh, const Label& label)
{
    PlaneMesh result;
    result.mesh = mesh;
    std::map<int, PlaneId> id;
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        const Eigen::Vector3d c = (corner(mesh, f, 0) + corner(mesh, f, 1) + corner(mesh, f, 2)) / 3.0;
        const auto [it, added] = id.try_emplace(label(c), static_cast<PlaneId>(id.size()));
        result.face_plane.push_back(it->second);
    }
    FittedPlanes fitted = fit_planes(mesh, result.face_plane, id.size(), {});
    result.plane = std::move(fitted.plane);
    result.moments = std::move(fitted.moments);
    result.vertex_class = classify_vertices(mesh, result.face_plane);
    return result;
}

MergeParams no_rules()
{
    MergeParams params;
    params.angle_test = params.distance_test = params.energy_rule = params.island_rule = params.absorb_rule = false;
    return params;
}

void expect_valid(const PlaneMesh& before, const PlaneMesh& after)
{
    EXPECT_EQ(after.mesh.face, before.mesh.face);
    ASSERT_EQ(after.face_plane.size(), before.face_plane.size());
    const std::set<PlaneId> used(after.face_plane.begin(), after.face_plane.end());
    EXPECT_EQ(used.size(), after.plane.size());
    EXPECT_EQ(*used.rbegin() + 1, after.plane.size());
    EXPECT_EQ(after.moments.size(), after.plane.size());
    std::vector<Moments> direct(after.plane.size());
    for (FaceId f = 0; f < after.mesh.face.size(); ++f)
        direct[after.face_plane[f]] +=
            triangle_moments(corner(after.mesh, f, 0), corner(after.mesh, f, 1), corner(after.mesh, f, 2));
    for (std::size_t p = 0; p < direct.size(); ++p) {
        EXPECT_NEAR(after.moments[p].area, direct[p].area, 1e-9);
        EXPECT_LT((after.moments[p].second - direct[p].second).norm(), 1e-9);
    }
    EXPECT_EQ(inspect(after).disconnected_planes, 0u);
}

// Stripes of width 0.1 along x on the unit square z(x, y).
template <class Height>
PlaneMesh stripes(const Height& z)
{
    return clustered(test::height_field(40, z), [](const Eigen::Vector3d& c) { return static_cast<int>(c.x() / 0.1); });
}

TEST(MergePlanes, CoplanarNeighboursAreOnePlane)
{
    const PlaneMesh mesh = stripes([](double, double) { return 0.0; });
    const PlaneMesh result = merge_planes(mesh, {});
    expect_valid(mesh, result);
    ASSERT_EQ(result.plane.size(), 1u);
    EXPECT_NEAR(result.plane[0].normal.z(), 1.0, 1e-12);
    EXPECT_NEAR(result.moments[0].area, 1.0, 1e-6);
}

TEST(MergePlanes, WithoutRulesEverythingStays)
{
    const PlaneMesh mesh = stripes([](double, double) { return 0.0; });
    const PlaneMesh result = merge_planes(mesh, no_rules());
    EXPECT_EQ(result.face_plane, mesh.face_plane);
    for (std::size_t p = 0; p < mesh.plane.size(); ++p)
        EXPECT_EQ(result.plane[p].normal, mesh.plane[p].normal);
}

TEST(MergePlanes, ARoofStaysTwoPlanesAboveTheAngleAndBecomesOneBelow)
{
    const PlaneMesh mesh = clustered(test::height_field(20, [](double x, double) { return 0.2 * std::abs(x - 0.5); }),
                                     [](const Eigen::Vector3d& c) { return c.x() < 0.5 ? 0 : 1; });
    EXPECT_EQ(merge_planes(mesh, {}).plane.size(), 2u); // 22.6 degrees
    MergeParams wide = no_rules();
    wide.angle_test = true;
    wide.max_angle = 25.0;
    EXPECT_EQ(merge_planes(mesh, wide).plane.size(), 1u);
    wide.distance_test = true;
    wide.max_distance = 0.01;
    EXPECT_EQ(merge_planes(mesh, wide).plane.size(), 2u) << "the distance test refuses what the angle allows";
}

TEST(MergePlanes, AGentlyCurvedSheetIsNotSwallowedWhole)
{
    const PlaneMesh mesh = stripes([](double x, double) { return 0.5 * x * x; });
    const PlaneMesh result = merge_planes(mesh, {});
    expect_valid(mesh, result);
    EXPECT_GT(result.plane.size(), 1u);
    for (const auto& moments : result.moments)
        EXPECT_LE(rms_to_fit(moments), 0.015);
}

// A box of the given height on [0.3, 0.6] x [0.3, 0.5] of a table of 2 m x 1 m: one cluster a side.
PlaneMesh book_on_table(double height, double noise)
{
    TriangleMesh table = test::grid({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, 100, 50);
    std::erase_if(table.face, [&](const Face& f) {
        const Eigen::Vector3f c = (table.position[f[0]] + table.position[f[1]] + table.position[f[2]]) / 3.0f;
        return c.x() > 0.3f && c.x() < 0.6f && c.y() > 0.3f && c.y() < 0.5f;
    });
    const Eigen::Vector3d a(0.3, 0.3, 0), x(0.3, 0, 0), y(0, 0.2, 0), z(0, 0, height);
    test::append(table, test::grid(a + z, x, y, 15, 10));
    test::append(table, test::grid(a, x, z, 15, 2));
    test::append(table, test::grid(a + x, y, z, 10, 2));
    test::append(table, test::grid(a + x + y, -x, z, 15, 2));
    test::append(table, test::grid(a + y, -y, z, 10, 2));
    TriangleMesh mesh = test::welded(table);
    PlaneMesh result = clustered(mesh, [&](const Eigen::Vector3d& c) {
        if (c.z() > height - 1e-6) return 1;
        if (c.z() < 1e-6) return 0;
        if (c.y() < 0.3 + 1e-6) return 2;
        if (c.x() > 0.6 - 1e-6) return 3;
        return c.y() > 0.5 - 1e-6 ? 4 : 5;
    });
    test::add_noise(mesh, noise, 1);
    const std::vector<PlaneId> labels = result.face_plane;
    FaceId next = 0;
    return clustered(mesh, [&](const Eigen::Vector3d&) { return static_cast<int>(labels[next++]); });
}

TEST(MergePlanes, ABookOnATableSurvives)
{
    for (const double height : {0.03, 0.05}) {
        const PlaneMesh mesh = book_on_table(height, 0.001);
        ASSERT_EQ(mesh.plane.size(), 6u);
        const PlaneMesh result = merge_planes(mesh, {});
        expect_valid(mesh, result);
        EXPECT_EQ(result.plane.size(), 6u) << height;
    }
}

TEST(MergePlanes, TheTopOfABookSurvivesEvenWhereItTouchesTheTable)
{
    // Without sides: the top is joined to the table by one steep row of faces that belongs to the table's cluster.
    const auto height = [](double x, double y) { return x > 0.3 && x < 0.6 && y > 0.3 && y < 0.5 ? 0.04 : 0.0; };
    const PlaneMesh mesh =
        clustered(test::height_field(100, height), [](const Eigen::Vector3d& c) { return c.z() > 0.039 ? 1 : 0; });
    EXPECT_EQ(merge_planes(mesh, {}).plane.size(), 2u);
}

TEST(MergePlanes, TheEnergyRuleTakesInABumpWhoseNormalsMeanNothing)
{
    // A bump of 1 cm, cut in four clusters of about 20 degrees, on a slightly wavy floor of 1 m^2.
    const auto height = [](double x, double y) {
        const double r = std::hypot(x - 0.5, y - 0.5);
        return 0.001 * std::sin(40 * x) * std::cos(37 * y) + (r < 0.03 ? 0.012 * (1 - r / 0.03) : 0.0);
    };
    const auto label = [](const Eigen::Vector3d& c) {
        if (std::hypot(c.x() - 0.5, c.y() - 0.5) > 0.03) return 0;
        return 1 + 2 * (c.x() > 0.5) + (c.y() > 0.5);
    };
    const PlaneMesh mesh = clustered(test::height_field(200, height), label);
    ASSERT_EQ(mesh.plane.size(), 5u);
    MergeParams params = no_rules();
    params.angle_test = params.distance_test = true;
    EXPECT_EQ(merge_planes(mesh, params).plane.size(), 5u) << "angles are too large";
    params.energy_rule = true;
    EXPECT_EQ(merge_planes(mesh, params).plane.size(), 1u);
}

// The unit floor with a three-sided pyramid of the given height in its middle.
PlaneMesh pyramid_on_floor(double height, double noise)
{
    const double radius = 0.3;
    const auto sector = [](double x, double y) {
        const double angle = std::atan2(y - 0.5, x - 0.5) / (2.0 * std::numbers::pi / 3.0);
        return static_cast<int>(std::floor(angle + 1.5));
    };
    const auto surface = [&](double x, double y) {
        const double middle = (sector(x, y) - 1.0) * 2.0 * std::numbers::pi / 3.0;
        const double along = (x - 0.5) * std::cos(middle) + (y - 0.5) * std::sin(middle);
        return std::max(0.0, height * (1.0 - along / (0.5 * radius)));
    };
    TriangleMesh mesh = test::height_field(120, surface);
    const PlaneMesh clean =
        clustered(mesh, [&](const Eigen::Vector3d& c) { return c.z() < 1e-4 ? 0 : 1 + sector(c.x(), c.y()) % 3; });
    const std::vector<PlaneId> labels = clean.face_plane;
    test::add_noise(mesh, noise, 1);
    FaceId next = 0;
    return clustered(mesh, [&](const Eigen::Vector3d&) { return static_cast<int>(labels[next++]); });
}

TEST(MergePlanes, APyramidOnAFloorKeepsFourClusters)
{
    for (const double height : {0.06, 0.15, 0.3}) {
        const PlaneMesh mesh = pyramid_on_floor(height, 0.001);
        ASSERT_EQ(mesh.plane.size(), 4u);
        const PlaneMesh result = merge_planes(mesh, {});
        expect_valid(mesh, result);
        EXPECT_EQ(result.plane.size(), 4u) << height;
    }
}

TEST(MergePlanes, APyramidThatPartitionFoundKeepsFourClusters)
{
    PartitionParams params;
    params.clusters = 4;
    const PlaneMesh mesh = partition(pyramid_on_floor(0.2, 0.002).mesh, params);
    ASSERT_EQ(mesh.plane.size(), 4u);
    EXPECT_EQ(merge_planes(mesh, {}).plane.size(), 4u);
}

// A patch of 10 cm x 10 cm in the middle of a unit floor, tilted about its middle line or lifted.
PlaneMesh patch_in_floor(double slope, double lift)
{
    const auto inside = [](double x, double y) { return std::abs(x - 0.5) < 0.05 && std::abs(y - 0.5) < 0.05; };
    return clustered(
        test::height_field(100, [&](double x, double y) { return inside(x, y) ? lift + slope * (x - 0.5) : 0.0; }),
        [&](const Eigen::Vector3d& c) { return inside(c.x(), c.y()) ? 1 : 0; });
}

TEST(MergePlanes, AnIslandJoinsTheNeighbourThatSurroundsItUnlessItIsFarOrLarge)
{
    MergeParams params = no_rules();
    params.island_rule = true;
    EXPECT_EQ(merge_planes(patch_in_floor(0.4, 0.0), params).plane.size(), 1u);
    EXPECT_EQ(merge_planes(patch_in_floor(0.0, 0.05), params).plane.size(), 2u) << "farther than island_max_distance";
    params.island_max_area = 0.005;
    EXPECT_EQ(merge_planes(patch_in_floor(0.4, 0.0), params).plane.size(), 2u) << "larger than island_max_area";
}

TEST(MergePlanes, AnIslandNeedsItsShareOfTheBorderNotJustANeighbour)
{
    // The patch lies on the mesh border: a quarter of its outline is no border with the floor.
    const auto inside = [](double x, double y) { return x < 0.1 && std::abs(y - 0.5) < 0.05; };
    const PlaneMesh mesh =
        clustered(test::height_field(100, [&](double x, double y) { return inside(x, y) ? 0.4 * (x - 0.05) : 0.0; }),
                  [&](const Eigen::Vector3d& c) { return inside(c.x(), c.y()) ? 1 : 0; });
    MergeParams params = no_rules();
    params.island_rule = true;
    EXPECT_EQ(merge_planes(mesh, params).plane.size(), 2u);
    params.island_border_share = 0.7;
    EXPECT_EQ(merge_planes(mesh, params).plane.size(), 1u);
}

TEST(MergePlanes, ATinyClusterGoesToTheNeighbourWhosePlaneIsNearest)
{
    // Floor and wall; the lowest centimetre of the wall is a cluster of its own, so is a piece of the floor next to it.
    const TriangleMesh corner_mesh = test::room_corner(50, 0.0);
    const PlaneMesh mesh = clustered(corner_mesh, [](const Eigen::Vector3d& c) {
        if (c.x() < 1e-6) return c.z() < 0.02 && c.y() > 0.5 && c.y() < 0.6 ? 3 : 1;
        return c.y() < 1e-6 ? 2 : 0;
    });
    MergeParams params = no_rules();
    params.absorb_rule = true;
    const PlaneMesh result = merge_planes(mesh, params);
    expect_valid(mesh, result);
    ASSERT_EQ(result.plane.size(), 3u);
    for (FaceId f = 0; f < mesh.face_plane.size(); ++f) {
        const Eigen::Vector3d c = (corner(mesh.mesh, f, 0) + corner(mesh.mesh, f, 1) + corner(mesh.mesh, f, 2)) / 3.0;
        if (c.x() < 1e-6) {
            EXPECT_NEAR(std::abs(result.plane[result.face_plane[f]].normal.x()), 1.0, 1e-6);
        }
    }
}

TEST(MergePlanes, TheTwoSidesOfAThinSheetStayApart)
{
    TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20);
    test::append(mesh, test::grid({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 20, 20));
    mesh = test::welded(mesh); // the sides share every vertex
    FaceId next = 0;
    const PlaneMesh sheet = clustered(mesh, [&](const Eigen::Vector3d&) { return next++ < 800 ? 0 : 1; });
    EXPECT_EQ(merge_planes(sheet, {}).plane.size(), 2u);
}

TEST(MergePlanes, RefusesPartsThatDoNotFitTogether)
{
    PlaneMesh mesh = stripes([](double, double) { return 0.0; });
    mesh.face_plane[5] = 99;
    test::error_of([&] { merge_planes(mesh, {}); }, ExitCode::Input);
    mesh.face_plane.pop_back();
    test::error_of([&] { merge_planes(mesh, {}); }, ExitCode::Input);
}

TEST(MergePlanes, OfOnePlaneAndOfNoneIsTheSame)
{
    const PlaneMesh one =
        clustered(test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2), [](const Eigen::Vector3d&) { return 0; });
    EXPECT_EQ(merge_planes(one, {}).plane.size(), 1u);
    EXPECT_EQ(merge_planes({}, {}).plane.size(), 0u);
}

TEST(MergePlanes, DropsPlanesWithoutFaces)
{
    PlaneMesh mesh =
        clustered(test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2), [](const Eigen::Vector3d&) { return 0; });
    mesh.plane.emplace_back();
    mesh.moments.emplace_back();
    EXPECT_EQ(merge_planes(mesh, {}).plane.size(), 1u);
}

TEST(MergePlanes, HasTheSameBytesForAnyNumberOfThreads)
{
    const PlaneMesh mesh = pyramid_on_floor(0.15, 0.002);
    set_thread_count(1);
    const PlaneMesh one = merge_planes(mesh, {});
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        const PlaneMesh many = merge_planes(mesh, {});
        EXPECT_EQ(one.face_plane, many.face_plane);
        for (std::size_t p = 0; p < one.plane.size(); ++p)
            EXPECT_EQ(one.plane[p].normal, many.plane[p].normal);
    }
    set_thread_count(0);
}

} // namespace
} // namespace quoin
