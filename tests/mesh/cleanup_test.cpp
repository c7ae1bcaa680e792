#include "mesh/cleanup.h"

#include "mesh/adjacency.h"

#include <gmock/gmock.h>
#include <limits>
#include <random>

namespace quoin {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

// Two triangles that make the unit square, each with its own vertices.
TriangleMesh torn_square()
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.color = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {5, 5, 5}};
    mesh.face = {{0, 1, 2}, {3, 4, 5}};
    return mesh;
}

TEST(WeldVertices, JoinsEqualPositionsAndKeepsTheFirstOfEach)
{
    auto mesh = torn_square();
    EXPECT_EQ(weld_vertices(mesh), 2u);
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 2}, Face{0, 2, 5}));
    EXPECT_EQ(remove_isolated_vertices(mesh), 2u);
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 2}, Face{0, 2, 3}));
    EXPECT_EQ(mesh.color[3], (Rgb8{5, 5, 5}));
}

TEST(WeldVertices, JoinsWithinTheToleranceOnly)
{
    auto mesh = torn_square();
    mesh.position[3] += Eigen::Vector3f(-0.004f, 0, 0.008f);
    mesh.position[4] += Eigen::Vector3f(0.02f, 0, 0);
    EXPECT_EQ(weld_vertices(mesh, 0.01), 1u);
    EXPECT_THAT(mesh.face[1], ElementsAre(0u, 4u, 5u));
}

TEST(WeldVertices, TreatsNegativeZeroAsZeroAndLeavesNaN)
{
    TriangleMesh mesh;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    mesh.position = {{0, 0, 0}, {-0.0f, 0, 0}, {nan, 0, 0}, {nan, 0, 0}};
    auto copy = mesh;
    EXPECT_EQ(weld_vertices(mesh), 1u);
    EXPECT_EQ(weld_vertices(copy, 0.1), 1u);
}

TEST(DropNonFinite, TakesTheFacesOfABadVertexAway)
{
    auto mesh = torn_square();
    mesh.position[1].y() = std::numeric_limits<float>::infinity();
    EXPECT_EQ(drop_non_finite(mesh), 1u);
    EXPECT_THAT(mesh.face, ElementsAre(Face{3, 4, 5}));
}

TEST(DropDegenerateFaces, TakesNeedlesAndRepeatedCornersAway)
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
    mesh.face = {{0, 1, 2}, {0, 1, 3}, {1, 1, 3}};
    EXPECT_EQ(drop_degenerate_faces(mesh), 2u);
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 3}));
}

TEST(DropDuplicateFaces, KeepsTheFirstWhateverOrderOrOrientation)
{
    TriangleMesh mesh;
    mesh.position.assign(5, Eigen::Vector3f::Zero());
    mesh.face = {{0, 1, 2}, {2, 0, 1}, {1, 2, 3}, {2, 1, 0}, {3, 2, 1}, {0, 1, 4}, {4, 0, 1}};
    EXPECT_EQ(drop_duplicate_faces(mesh), 4u);
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 2}, Face{1, 2, 3}, Face{0, 1, 4}));
}

TEST(DropSmallComponents, AsksForEnoughFacesAndEnoughArea)
{
    TriangleMesh mesh = torn_square();
    weld_vertices(mesh);
    mesh.position.insert(mesh.position.end(), {{5, 0, 0}, {9, 0, 0}, {9, 4, 0}}); // large, but one face
    mesh.position.insert(mesh.position.end(),
                         {{20, 0, 0}, {20.1f, 0, 0}, {20.1f, 0.1f, 0}, {20, 0.1f, 0}}); // two small ones
    mesh.face.insert(mesh.face.end(), {{6, 7, 8}, {9, 10, 11}, {9, 11, 12}});
    auto copy = mesh;
    const auto by_faces = drop_small_components(mesh, 2, 0.0);
    EXPECT_EQ(by_faces.components, 1u);
    EXPECT_EQ(by_faces.faces, 1u);
    EXPECT_EQ(mesh.face.size(), 4u);
    const auto by_area = drop_small_components(copy, 0, 0.5);
    EXPECT_EQ(by_area.faces, 2u);
    EXPECT_THAT(copy.face, ElementsAre(Face{0, 1, 2}, Face{0, 2, 5}, Face{6, 7, 8}));
}

TEST(SplitTouchingFans, GivesABowTieTwoVertices)
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}};
    mesh.color.assign(5, Rgb8{1, 2, 3});
    mesh.face = {{0, 1, 2}, {0, 3, 4}};
    EXPECT_EQ(split_touching_fans(mesh), 1u);
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 2}, Face{5, 3, 4}));
    EXPECT_EQ(mesh.position[5], mesh.position[0]);
    EXPECT_EQ(mesh.color.size(), 6u);
}

TEST(SplitTouchingFans, LeavesAClosedFanAndABorderAlone)
{
    TriangleMesh mesh;
    mesh.position.assign(5, Eigen::Vector3f::Zero());
    mesh.face = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    const auto faces = mesh.face;
    EXPECT_EQ(split_touching_fans(mesh), 0u);
    EXPECT_EQ(mesh.face, faces);
}

TEST(SortAlongMorton, BringsNeighboursTogetherAndKeepsTheSurface)
{
    constexpr std::uint32_t kSide = 32;
    std::vector<VertexId> name(kSide * kSide);
    for (VertexId v = 0; v < name.size(); ++v)
        name[v] = v;
    std::shuffle(name.begin(), name.end(), std::mt19937(3));
    TriangleMesh mesh;
    mesh.position.resize(name.size());
    for (std::uint32_t i = 0; i < name.size(); ++i)
        mesh.position[name[i]] = {float(i % kSide), float(i / kSide), 0};
    for (std::uint32_t i = 0; i + kSide < name.size(); ++i)
        if (i % kSide + 1 < kSide) mesh.face.push_back({name[i], name[i + 1], name[i + kSide]});
    const auto corners_of = [](const TriangleMesh& m) {
        std::vector<std::vector<float>> corners;
        for (const auto& f : m.face)
            corners.push_back({m.position[f[0]].x(), m.position[f[0]].y(), m.position[f[2]].y()});
        std::sort(corners.begin(), corners.end());
        return corners;
    };
    const auto stride = [](const TriangleMesh& m) {
        double sum = 0;
        for (const auto& f : m.face)
            sum += std::abs(double(f[0]) - double(f[1]));
        return sum / double(m.face.size());
    };
    const auto before = corners_of(mesh);
    const double stride_before = stride(mesh);
    sort_along_morton(mesh);
    EXPECT_EQ(corners_of(mesh), before);
    EXPECT_LT(stride(mesh), 0.2 * stride_before);
    EXPECT_EQ(mesh.position[0], Eigen::Vector3f::Zero());
    const auto first = [](const Face& f) { return std::min({f[0], f[1], f[2]}); };
    for (std::size_t f = 1; f < mesh.face.size(); ++f)
        EXPECT_LE(first(mesh.face[f - 1]), first(mesh.face[f]));
}

TEST(CleanUp, ReportsWhatItRemoved)
{
    auto mesh = torn_square();
    mesh.position.insert(mesh.position.end(), {{9, 9, 9}, {9, 9, 9}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}});
    mesh.color.resize(9);
    mesh.face.insert(mesh.face.end(), {{0, 1, 8}, {6, 7, 0}, {2, 1, 0}});
    const auto report = clean_up(mesh);
    EXPECT_EQ(report.non_finite_vertices, 1u);
    EXPECT_EQ(report.welded_vertices, 3u);
    EXPECT_EQ(report.degenerate_faces, 1u);
    EXPECT_EQ(report.duplicate_faces, 1u);
    EXPECT_EQ(report.isolated_vertices, 5u);
    EXPECT_EQ(mesh.position.size(), 4u);
    EXPECT_EQ(mesh.face.size(), 2u);
}

TEST(CleanUp, OfAnEmptyMeshDoesNothing)
{
    TriangleMesh mesh;
    clean_up(mesh, {0.01, 10, 1.0});
    EXPECT_TRUE(mesh.position.empty());
}

} // namespace
} // namespace quoin
