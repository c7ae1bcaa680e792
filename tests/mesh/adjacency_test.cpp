#include "mesh/adjacency.h"

#include <gmock/gmock.h>
#include <random>

namespace quoin {
namespace {

using ::testing::ElementsAre;

TriangleMesh with_faces(std::size_t vertices, std::vector<Face> faces)
{
    TriangleMesh mesh;
    mesh.position.assign(vertices, Eigen::Vector3f::Zero());
    mesh.face = std::move(faces);
    return mesh;
}

TEST(OppositeHalfEdges, PairTheCommonEdgeOfTwoTriangles)
{
    const auto opposite = opposite_half_edges(with_faces(4, {{0, 1, 2}, {2, 1, 3}}));
    EXPECT_THAT(opposite, ElementsAre(kBorderEdge, 3u, kBorderEdge, 1u, kBorderEdge, kBorderEdge));
}

TEST(OppositeHalfEdges, PairAnEdgeThatBothFacesRunTheSameWay)
{
    const auto opposite = opposite_half_edges(with_faces(4, {{0, 1, 2}, {1, 2, 3}}));
    EXPECT_EQ(opposite[1], 3u);
    EXPECT_EQ(opposite[3], 1u);
}

TEST(OppositeHalfEdges, MarkAnEdgeOfThreeFaces)
{
    const auto opposite = opposite_half_edges(with_faces(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    EXPECT_EQ(opposite[0], kNonManifoldEdge);
    EXPECT_EQ(opposite[3], kNonManifoldEdge);
    EXPECT_EQ(opposite[6], kNonManifoldEdge);
    EXPECT_EQ(opposite[1], kBorderEdge);
}

TEST(OppositeHalfEdges, OfNoFacesAreNone) { EXPECT_TRUE(opposite_half_edges({}).empty()); }

TEST(OppositeHalfEdges, AreAnInvolutionOnAGridWithShuffledVertices)
{
    constexpr std::uint32_t kSide = 60; // more vertices than one radix digit holds
    std::vector<VertexId> name(kSide * kSide);
    for (VertexId v = 0; v < name.size(); ++v)
        name[v] = v;
    std::shuffle(name.begin(), name.end(), std::mt19937(7));
    std::vector<Face> faces;
    for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
        for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
            const std::uint32_t a = y * kSide + x;
            faces.push_back({name[a], name[a + 1], name[a + kSide]});
            faces.push_back({name[a + 1], name[a + kSide + 1], name[a + kSide]});
        }
    }
    const auto mesh = with_faces(name.size(), faces);
    const auto opposite = opposite_half_edges(mesh);
    std::size_t borders = 0;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        if (opposite[h] == kBorderEdge) {
            ++borders;
            continue;
        }
        const std::uint32_t o = opposite[h];
        ASSERT_EQ(opposite[o], h);
        EXPECT_EQ(mesh.face[h / 3][h % 3], mesh.face[o / 3][(o % 3 + 1) % 3]);
        EXPECT_EQ(mesh.face[o / 3][o % 3], mesh.face[h / 3][(h % 3 + 1) % 3]);
    }
    EXPECT_EQ(borders, 4 * (kSide - 1));
}

TEST(VertexFaces, ListFacesAscendingAndNoneForAnIsolatedVertex)
{
    const auto around = vertex_faces(with_faces(5, {{0, 1, 2}, {2, 1, 3}}));
    EXPECT_THAT(around.of(0), ElementsAre(0u));
    EXPECT_THAT(around.of(1), ElementsAre(0u, 1u));
    EXPECT_THAT(around.of(3), ElementsAre(1u));
    EXPECT_TRUE(around.of(4).empty());
}

TEST(FaceComponents, SplitFacesThatMeetInAVertexOnly)
{
    EXPECT_THAT(face_components(with_faces(5, {{0, 1, 2}, {2, 3, 4}})), ElementsAre(0u, 1u));
}

TEST(FaceComponents, AreNumberedByTheirFirstFace)
{
    const auto components = face_components(with_faces(7, {{4, 5, 6}, {0, 1, 2}, {2, 1, 3}, {6, 5, 4}}));
    EXPECT_THAT(components, ElementsAre(0u, 1u, 1u, 0u));
}

} // namespace
} // namespace quoin
