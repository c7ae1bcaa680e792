#include "fusion/marching_cubes.h"

#include <algorithm>
#include <bit>
#include <gmock/gmock.h>
#include <map>
#include <set>

namespace quoin {
namespace {

using DirectedEdge = std::pair<int, int>;

// Edges of a cell's patch that are not shared by two of its triangles: its contour.
std::set<DirectedEdge> contour_of(unsigned inside)
{
    std::set<DirectedEdge> all;
    for (const auto& t : cell_triangles()[inside])
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_TRUE(all.insert({t[k], t[(k + 1) % 3]}).second) << inside;
    std::set<DirectedEdge> contour;
    for (const auto& [a, b] : all)
        if (!all.contains({b, a})) contour.insert({a, b});
    return contour;
}

bool on_face(int edge, int axis, int side)
{
    const auto e = cell_edges()[static_cast<std::size_t>(edge)];
    return e.axis != axis && (e.corner >> axis & 1) == side;
}

// The same edge on the opposite face, as the neighbouring cell numbers it.
int across(int edge, int axis)
{
    const auto e = cell_edges()[static_cast<std::size_t>(edge)];
    for (int other = 0; other < kCellEdges; ++other) {
        const auto o = cell_edges()[static_cast<std::size_t>(other)];
        if (o.axis == e.axis && o.corner == (e.corner ^ (1 << axis))) return other;
    }
    return -1;
}

TEST(MarchingCubes, UseEveryCrossedEdgeAndNoOther)
{
    for (unsigned inside = 0; inside < 256; ++inside) {
        std::set<int> used, crossed;
        for (const auto& t : cell_triangles()[inside])
            used.insert(t.begin(), t.end());
        for (int e = 0; e < kCellEdges; ++e) {
            const auto [corner, axis] = cell_edges()[static_cast<std::size_t>(e)];
            if ((inside >> corner & 1) != (inside >> (corner ^ (1 << axis)) & 1)) crossed.insert(e);
        }
        EXPECT_EQ(used, crossed) << inside;
    }
}

TEST(MarchingCubes, HaveTheirContourOnFacesAndNoDiagonalThere)
{
    for (unsigned inside = 0; inside < 256; ++inside) {
        const auto contour = contour_of(inside);
        for (const auto& t : cell_triangles()[inside]) {
            for (std::size_t k = 0; k < 3; ++k) {
                const int a = t[k], b = t[(k + 1) % 3];
                bool shares_face = false;
                for (int axis = 0; axis < 3; ++axis)
                    for (int side = 0; side < 2; ++side)
                        shares_face |= on_face(a, axis, side) && on_face(b, axis, side);
                EXPECT_EQ(shares_face, contour.contains({a, b})) << inside;
            }
        }
    }
}

TEST(MarchingCubes, MeetWithoutGapsAcrossEveryFaceOfAnyTwoCells)
{
    for (int axis = 0; axis < 3; ++axis) {
        std::map<unsigned, std::set<DirectedEdge>> seen; // by the corners of the common face
        for (unsigned inside = 0; inside < 512; ++inside) {
            const unsigned corners = inside & 255;
            const int side = inside < 256 ? 1 : 0;
            unsigned shared = 0;
            for (unsigned c = 0; c < 8; ++c)
                if (static_cast<int>(c >> axis & 1) == side && (corners >> c & 1)) shared |= 1u << (c & ~(1u << axis));
            std::set<DirectedEdge> contour;
            for (auto [a, b] : contour_of(corners)) {
                if (!on_face(a, axis, side) || !on_face(b, axis, side)) continue;
                if (side == 1)
                    contour.insert({across(a, axis), across(b, axis)});
                else
                    contour.insert({b, a}); // the neighbour runs it the other way
            }
            const auto [it, is_new] = seen.try_emplace(shared, contour);
            EXPECT_EQ(it->second, contour) << "axis " << axis << " corners " << corners;
        }
    }
}

TEST(MarchingCubes, NeedAtMostFiveTriangles)
{
    for (const auto& triangles : cell_triangles())
        EXPECT_LE(triangles.size(), 5u);
}

} // namespace
} // namespace quoin
