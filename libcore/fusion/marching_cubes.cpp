#include "fusion/marching_cubes.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace quoin {
namespace {

using Corner = std::uint8_t;
using Edge = std::uint8_t;
constexpr Edge kNone = 255;

std::array<CellEdge, kCellEdges> make_edges()
{
    std::array<CellEdge, kCellEdges> edges{};
    std::size_t count = 0;
    for (std::uint8_t axis = 0; axis < 3; ++axis)
        for (Corner corner = 0; corner < 8; ++corner)
            if (!(corner >> axis & 1)) edges[count++] = {corner, axis};
    return edges;
}

Edge edge_between(Corner a, Corner b)
{
    const Corner low = std::min(a, b);
    const auto& edges = cell_edges();
    const auto joins = [&](const CellEdge& e) { return e.corner == low && (low ^ (1 << e.axis)) == std::max(a, b); };
    return static_cast<Edge>(std::find_if(edges.begin(), edges.end(), joins) - edges.begin());
}

// Corners of the six faces, counter-clockwise seen from outside the cell.
std::array<std::array<Corner, 4>, 6> make_faces()
{
    std::array<std::array<Corner, 4>, 6> faces{};
    for (int axis = 0; axis < 3; ++axis) {
        const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
        for (int side = 0; side < 2; ++side) {
            const int base = side << axis;
            auto& face = faces[static_cast<std::size_t>(2 * axis + side)];
            face = {Corner(base), Corner(base + u), Corner(base + u + v), Corner(base + v)};
            if (side == 0) std::reverse(face.begin(), face.end());
        }
    }
    return faces;
}

bool share_a_face(Edge a, Edge b)
{
    const auto on_face = [](Edge e, int axis, int side) {
        const CellEdge edge = cell_edges()[e];
        return edge.axis != axis && (edge.corner >> axis & 1) == side;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            if (on_face(a, axis, side) && on_face(b, axis, side)) return true;
    return false;
}

// The contour on the cell's faces: from the crossing at edge e it runs to the crossing at edge next[e]. Every run of
// inside corners around a face is cut off by one segment.
std::array<Edge, kCellEdges> contour(unsigned inside)
{
    std::array<Edge, kCellEdges> next;
    next.fill(kNone);
    for (const auto& face : make_faces()) {
        const auto is_inside = [&](std::size_t i) { return (inside >> face[i % 4] & 1) != 0; };
        for (std::size_t first = 0; first < 4; ++first) {
            if (!is_inside(first) || is_inside(first + 3)) continue;
            std::size_t last = first;
            while (is_inside(last + 1))
                ++last;
            const Edge enters = edge_between(face[(first + 3) % 4], face[first]);
            const Edge leaves = edge_between(face[last % 4], face[(last + 1) % 4]);
            next[enters] = leaves;
        }
    }
    return next;
}

struct Triangulation {
    std::vector<CellTriangle> triangles;
    int diagonals_on_faces = 0;
};

// Of all triangulations of a polygon the first one with the fewest diagonals on a face of the cell.
Triangulation triangulate(std::span<const Edge> polygon)
{
    if (polygon.size() < 3) return {};
    const std::size_t last = polygon.size() - 1;
    Triangulation best;
    best.diagonals_on_faces = std::numeric_limits<int>::max();
    for (std::size_t apex = 1; apex < last; ++apex) {
        Triangulation candidate = triangulate(polygon.first(apex + 1));
        const Triangulation rest = triangulate(polygon.subspan(apex));
        const bool left = apex > 1 && share_a_face(polygon[0], polygon[apex]);
        const bool right = apex + 1 < last && share_a_face(polygon[apex], polygon[last]);
        candidate.diagonals_on_faces += rest.diagonals_on_faces + (left ? 1 : 0) + (right ? 1 : 0);
        candidate.triangles.push_back({polygon[0], polygon[apex], polygon[last]});
        candidate.triangles.insert(candidate.triangles.end(), rest.triangles.begin(), rest.triangles.end());
        if (candidate.diagonals_on_faces < best.diagonals_on_faces) best = std::move(candidate);
    }
    return best;
}

std::vector<CellTriangle> triangles_of(unsigned inside)
{
    auto next = contour(inside);
    std::vector<CellTriangle> triangles;
    for (Edge start = 0; start < kCellEdges; ++start) {
        std::vector<Edge> loop;
        for (Edge e = start; next[e] != kNone;) {
            loop.push_back(e);
            const Edge following = next[e];
            next[e] = kNone;
            e = following;
        }
        const auto patch = triangulate(loop).triangles;
        triangles.insert(triangles.end(), patch.begin(), patch.end());
    }
    return triangles;
}

std::array<std::vector<CellTriangle>, 256> make_triangles()
{
    std::array<std::vector<CellTriangle>, 256> table;
    for (unsigned inside = 0; inside < 256; ++inside)
        table[inside] = triangles_of(inside);
    return table;
}

} // namespace

const std::array<CellEdge, kCellEdges>& cell_edges()
{
    static const auto edges = make_edges();
    return edges;
}

const std::array<std::vector<CellTriangle>, 256>& cell_triangles()
{
    static const auto table = make_triangles();
    return table;
}

} // namespace quoin
