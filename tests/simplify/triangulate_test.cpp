#include "simplify/triangulate.h"

#include "mesh/hygiene.h"
#include "simplify/stitch.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

// Closed polygons, each through the points that follow those of the one before; the inside is to the left.
Outline outline(const std::vector<std::vector<Eigen::Vector2d>>& loops)
{
    Outline result;
    for (const auto& loop : loops) {
        const auto first = static_cast<std::uint32_t>(result.point.size()),
                   count = static_cast<std::uint32_t>(loop.size());
        for (std::uint32_t i = 0; i < count; ++i)
            result.segment.push_back({first + i, first + (i + 1) % count});
        result.point.insert(result.point.end(), loop.begin(), loop.end());
    }
    return result;
}

double area(const Outline& outline, const std::vector<Face>& faces)
{
    double sum = 0.0;
    for (const auto& [a, b, c] : faces) {
        const Eigen::Vector2d u = outline.point[b] - outline.point[a], v = outline.point[c] - outline.point[a];
        const double twice = u.x() * v.y() - u.y() * v.x();
        EXPECT_GT(twice, 0.0) << "faces are counter-clockwise";
        sum += 0.5 * twice;
    }
    return sum;
}

TEST(Triangulate, FillsASquareWithTwoFaces)
{
    const Outline square = outline({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
    const auto faces = triangulate(square);
    ASSERT_TRUE(faces);
    EXPECT_EQ(faces->size(), 2u);
    EXPECT_DOUBLE_EQ(area(square, *faces), 1.0);
}

TEST(Triangulate, LeavesAHoleOpenAndFillsAnIslandInIt)
{
    const Outline ring = outline({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {1, 3}, {3, 3}, {3, 1}}});
    const auto faces = triangulate(ring);
    ASSERT_TRUE(faces);
    EXPECT_DOUBLE_EQ(area(ring, *faces), 12.0);
    const Outline island = outline({{{0, 0}, {4, 0}, {4, 4}, {0, 4}},
                                    {{1, 1}, {1, 3}, {3, 3}, {3, 1}},
                                    {{1.5, 1.5}, {2.5, 1.5}, {2.5, 2.5}, {1.5, 2.5}}});
    const auto more = triangulate(island);
    ASSERT_TRUE(more);
    EXPECT_DOUBLE_EQ(area(island, *more), 13.0);
}

TEST(Triangulate, FillsTwoPiecesThatTouchInAPoint)
{
    Outline bow = outline({{{0, 0}, {1, 0}, {1, 1}}, {{1, 1}, {2, 1}, {2, 2}}});
    bow.point.erase(bow.point.begin() + 3); // the second loop starts where the first one ended
    for (auto& segment : bow.segment)
        for (auto& end : segment)
            end = end > 2 ? end - 1 : end;
    EXPECT_TRUE(crossings(bow).empty());
    const auto faces = triangulate(bow);
    ASSERT_TRUE(faces);
    EXPECT_DOUBLE_EQ(area(bow, *faces), 1.0);
}

TEST(Triangulate, RefusesBordersThatCrossOrRunTheWrongWay)
{
    EXPECT_FALSE(triangulate(outline({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}})));
    EXPECT_FALSE(triangulate(outline({{{0, 0}, {0, 1}, {1, 1}, {1, 0}}}))) << "the inside would be infinite";
    EXPECT_FALSE(triangulate(outline({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}})))
        << "a hole whose inside is on the other side";
    EXPECT_FALSE(triangulate(outline({{{0, 0}, {1, 0}, {2, 0}}}))) << "no inside";
    EXPECT_FALSE(triangulate({}));
}

TEST(Crossings, NameThePairsThatTouch)
{
    const auto found = crossings(outline({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(std::min(found[0][0], found[0][1]), 0u);
    EXPECT_EQ(std::max(found[0][0], found[0][1]), 2u);
    EXPECT_EQ(crossings(outline({{{0, 0}, {2, 0}, {1, 0}, {1, 1}}})).size(), 2u)
        << "an edge that turns back lies on the one before, and its end on it touches";
}

TEST(SplitSharedChords, MakesAPillowOfTwoPlanesManifold)
{
    PlaneMesh pillow;
    pillow.mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    pillow.mesh.face = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
    pillow.face_plane = {0, 0, 1, 1};
    pillow.plane.resize(2);
    ASSERT_EQ(inspect(pillow.mesh).non_manifold_edges, 1u);
    split_shared_chords(pillow);
    const Hygiene found = inspect(pillow.mesh);
    EXPECT_EQ(found.non_manifold_edges + found.duplicate_faces + found.bow_tie_vertices + found.inconsistent_edges, 0u);
    EXPECT_EQ(found.euler_characteristic, 2);
}

TEST(SplitSharedChords, MakesTwoTrianglesOnEachOtherDifferent)
{
    PlaneMesh pillow;
    pillow.mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
    pillow.mesh.face = {{0, 1, 2}, {0, 2, 1}};
    pillow.face_plane = {0, 1};
    pillow.plane.resize(2);
    split_shared_chords(pillow);
    const Hygiene found = inspect(pillow.mesh);
    EXPECT_EQ(found.duplicate_faces + found.non_manifold_edges, 0u);
    EXPECT_EQ(found.euler_characteristic, 2);
}

} // namespace
} // namespace quoin
