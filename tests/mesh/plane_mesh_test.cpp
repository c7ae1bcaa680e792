#include "mesh/plane_mesh.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

// A flat grid of side x side vertices; face 2 i and 2 i + 1 are the halves of cell i.
TriangleMesh grid(std::uint32_t side)
{
    TriangleMesh mesh;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x)
            mesh.position.emplace_back(float(x), float(y), 0.0f);
    for (std::uint32_t y = 0; y + 1 < side; ++y) {
        for (std::uint32_t x = 0; x + 1 < side; ++x) {
            const std::uint32_t a = y * side + x;
            mesh.face.push_back({a, a + 1, a + side});
            mesh.face.push_back({a + 1, a + side + 1, a + side});
        }
    }
    return mesh;
}

// Planes by the cell's column and row.
template <class PlaneOf>
std::vector<PlaneId> label(std::uint32_t side, const PlaneOf& plane_of)
{
    std::vector<PlaneId> planes;
    for (std::uint32_t y = 0; y + 1 < side; ++y)
        for (std::uint32_t x = 0; x + 1 < side; ++x)
            planes.insert(planes.end(), 2, plane_of(x, y));
    return planes;
}

TEST(ClassifyVertices, OfOnePlaneAreInnerButOnTheMeshBorder)
{
    const auto classes = classify_vertices(grid(4), label(4, [](auto, auto) { return 0u; }));
    for (std::uint32_t v = 0; v < 16; ++v) {
        const bool inside = v % 4 > 0 && v % 4 < 3 && v / 4 > 0 && v / 4 < 3;
        EXPECT_EQ(classes[v], inside ? VertexClass::Inner : VertexClass::Border) << v;
    }
}

TEST(ClassifyVertices, OnTheCurveOfTwoPlanesAreBorderAndItsEndsAreCorners)
{
    const auto classes = classify_vertices(grid(5), label(5, [](auto x, auto) { return x < 2 ? 0u : 1u; }));
    EXPECT_EQ(classes[5 + 2], VertexClass::Border);
    EXPECT_EQ(classes[15 + 2], VertexClass::Border);
    EXPECT_EQ(classes[2], VertexClass::Corner);
    EXPECT_EQ(classes[20 + 2], VertexClass::Corner);
    EXPECT_EQ(classes[5 + 1], VertexClass::Inner);
    EXPECT_EQ(classes[5 + 3], VertexClass::Inner);
}

TEST(ClassifyVertices, WhereThreePlanesMeetIsACorner)
{
    const auto classes = classify_vertices(grid(5), label(5, [](auto x, auto y) {
                                               return x < 2 ? 0u : y < 2 ? 1u : 2u;
                                           }));
    EXPECT_EQ(classes[10 + 2], VertexClass::Corner);
    EXPECT_EQ(classes[10 + 3], VertexClass::Border);
}

TEST(ClassifyVertices, OnAnEdgeOfThreeFacesAreCorners)
{
    TriangleMesh fan;
    fan.position.assign(5, Eigen::Vector3f::Zero());
    fan.face = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    const auto classes = classify_vertices(fan, {0, 0, 0});
    EXPECT_EQ(classes[0], VertexClass::Corner);
    EXPECT_EQ(classes[1], VertexClass::Corner);
    EXPECT_EQ(classes[2], VertexClass::Border);
}

TEST(ClassifyVertices, OfAnIslandInsideAPlaneAreABorderWithoutCorners)
{
    const auto inside = [](auto i) { return i == 1 || i == 2; };
    const auto classes =
        classify_vertices(grid(5), label(5, [&](auto x, auto y) { return inside(x) && inside(y) ? 1u : 0u; }));
    EXPECT_EQ(classes[10 + 2], VertexClass::Inner);
    for (const std::uint32_t v : {6u, 7u, 8u, 11u, 13u, 16u, 17u, 18u})
        EXPECT_EQ(classes[v], VertexClass::Border) << v;
}

} // namespace
} // namespace quoin
