#include "simplify/triangulate.h"

#include "base/parallel.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/Unique_hash_map.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <utility>

namespace quoin {
namespace {

constexpr std::size_t kSegmentGrain = 256;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
enum class Side : std::uint8_t { Unknown, Inside, Outside };
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<Side, Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_tag>;
using FaceHandle = Triangulation::Face_handle;
using VertexHandle = Triangulation::Vertex_handle;

Kernel::Point_2 point_of(const Outline& outline, std::uint32_t i)
{
    return {outline.point[i].x(), outline.point[i].y()};
}

bool on_each_other(const Outline& outline, std::uint32_t apex, std::uint32_t a, std::uint32_t b)
{
    const auto p = point_of(outline, apex), q = point_of(outline, a), r = point_of(outline, b);
    return CGAL::orientation(p, q, r) == CGAL::COLLINEAR && !CGAL::collinear_are_strictly_ordered_along_line(q, p, r);
}

bool cross(const Outline& outline, std::uint32_t i, std::uint32_t j)
{
    const auto [a, b] = outline.segment[i];
    const auto [c, d] = outline.segment[j];
    if (a == c && b == d) return true;
    if (a == d && b == c) return true;
    if (a == c || a == d) return on_each_other(outline, a, b, a == c ? d : c);
    if (b == c || b == d) return on_each_other(outline, b, a, b == c ? d : c);
    return CGAL::do_intersect(Kernel::Segment_2(point_of(outline, a), point_of(outline, b)),
                              Kernel::Segment_2(point_of(outline, c), point_of(outline, d)));
}

// Points and constraints; false if these do not make a triangulation with just these vertices and edges.
bool insert(const Outline& outline, Triangulation& triangulation, std::vector<VertexHandle>& vertex)
{
    FaceHandle near;
    for (std::uint32_t i = 0; i < outline.point.size(); ++i) { // one by one: CGAL shuffles ranges
        vertex.push_back(triangulation.insert(point_of(outline, i), near));
        vertex.back()->info() = i;
        near = vertex.back()->face();
    }
    if (triangulation.number_of_vertices() != outline.point.size()) return false;
    for (const auto& [a, b] : outline.segment)
        triangulation.insert_constraint(vertex[a], vertex[b]);
    return triangulation.dimension() == 2;
}

bool mark(FaceHandle face, Side side)
{
    if (face->info() != Side::Unknown) return face->info() == side;
    face->info() = side;
    return true;
}

// Marks the faces to both sides of the segments; false where two of them contradict each other.
bool mark_along_segments(const Outline& outline, const std::vector<VertexHandle>& vertex,
                         const Triangulation& triangulation)
{
    for (const auto& [a, b] : outline.segment) {
        FaceHandle face;
        int i = 0;
        if (!triangulation.is_edge(vertex[a], vertex[b], face, i)) return false; // it runs through a third point
        const FaceHandle other = face->neighbor(i);
        const bool left = face->vertex(Triangulation::ccw(i)) == vertex[a];
        if (!mark(left ? face : other, Side::Inside) || !mark(left ? other : face, Side::Outside)) return false;
    }
    return true;
}

// Spreads the marks to where no segment is between; false where they meet others.
bool spread_marks(Triangulation& triangulation)
{
    std::vector<FaceHandle> stack;
    for (const auto face : triangulation.all_face_handles())
        if (face->info() != Side::Unknown) stack.push_back(face);
    while (!stack.empty()) {
        const FaceHandle face = stack.back();
        stack.pop_back();
        for (int i = 0; i < 3; ++i) {
            if (face->is_constrained(i)) continue;
            const FaceHandle next = face->neighbor(i);
            if (next->info() == Side::Unknown) {
                next->info() = face->info();
                stack.push_back(next);
            }
            if (next->info() != face->info()) return false;
        }
    }
    return triangulation.infinite_face()->info() == Side::Outside;
}

// Numbers the regions between the segments.
using RegionMap = CGAL::Unique_hash_map<FaceHandle, std::uint32_t>;
RegionMap find_regions(const Triangulation& triangulation, std::uint32_t& count)
{
    constexpr std::uint32_t kNone = 0xffffffffu;
    RegionMap region(kNone);
    for (const auto start : triangulation.all_face_handles()) {
        if (region[start] != kNone) continue;
        std::vector<FaceHandle> stack{start};
        region[start] = count;
        while (!stack.empty()) {
            const FaceHandle face = stack.back();
            stack.pop_back();
            for (int i = 0; i < 3; ++i) {
                const FaceHandle next = face->neighbor(i);
                if (face->is_constrained(i) || region[next] != kNone) continue;
                region[next] = count;
                stack.push_back(next);
            }
        }
        ++count;
    }
    return region;
}

std::vector<Face> inside_faces(const Triangulation& triangulation)
{
    std::vector<Face> faces;
    for (const auto face : triangulation.finite_face_handles()) {
        if (face->info() != Side::Inside) continue;
        Face ids{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
        std::rotate(ids.begin(), std::min_element(ids.begin(), ids.end()), ids.end());
        faces.push_back(ids);
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

struct Extent {
    double low_x, high_x, low_y, high_y;
    std::uint32_t segment;
};

// From left to right.
std::vector<Extent> sorted_extents(const Outline& outline)
{
    std::vector<Extent> extents;
    extents.reserve(outline.segment.size());
    for (std::uint32_t i = 0; i < outline.segment.size(); ++i) {
        const auto &p = outline.point[outline.segment[i][0]], &q = outline.point[outline.segment[i][1]];
        extents.push_back(
            {std::min(p.x(), q.x()), std::max(p.x(), q.x()), std::min(p.y(), q.y()), std::max(p.y(), q.y()), i});
    }
    std::ranges::sort(extents, {}, [](const Extent& e) { return std::pair(e.low_x, e.segment); });
    return extents;
}

} // namespace

std::vector<std::array<std::uint32_t, 2>> crossings(const Outline& outline)
{
    using Pairs = std::vector<std::array<std::uint32_t, 2>>;
    const auto extents = sorted_extents(outline);
    const auto from = [&](std::size_t begin, std::size_t end) {
        Pairs found;
        for (std::size_t i = begin; i < end; ++i) {
            const Extent& e = extents[i];
            for (std::size_t j = i + 1; j < extents.size() && extents[j].low_x <= e.high_x; ++j) {
                const Extent& other = extents[j];
                if (other.low_y > e.high_y || other.high_y < e.low_y) continue;
                if (cross(outline, e.segment, other.segment)) found.push_back({e.segment, other.segment});
            }
        }
        return found;
    };
    const auto append = [](Pairs all, const Pairs& more) {
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    return parallel_reduce(extents.size(), kSegmentGrain, Pairs(), from, append);
}

double crossing_parameter(const Outline& outline, std::uint32_t i, std::uint32_t j)
{
    const auto [a, b] = outline.segment[i];
    const auto [c, d] = outline.segment[j];
    const Eigen::Vector2d along = outline.point[b] - outline.point[a], other = outline.point[d] - outline.point[c];
    const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); };
    const double turn = cross(along, other);
    if (turn == 0.0) return 0.5;
    return std::clamp(cross(outline.point[c] - outline.point[a], other) / turn, 0.0, 1.0);
}

std::vector<std::uint32_t> contradictions(const Outline& outline)
{
    Triangulation triangulation;
    std::vector<VertexHandle> vertex;
    if (outline.segment.size() < 3) return {};
    try {
        if (!insert(outline, triangulation, vertex)) return {};
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        return {};
    }
    std::uint32_t count = 0;
    const RegionMap regions = find_regions(triangulation, count);
    std::vector<int> votes(count, 0); // for the inside
    votes[regions[triangulation.infinite_face()]] = -static_cast<int>(outline.segment.size()) - 1;
    std::vector<std::array<std::uint32_t, 2>> sides; // regions left and right of every segment
    for (const auto& [a, b] : outline.segment) {
        FaceHandle face;
        int i = 0;
        if (!triangulation.is_edge(vertex[a], vertex[b], face, i)) return {};
        const bool left = face->vertex(Triangulation::ccw(i)) == vertex[a];
        const std::uint32_t one = regions[face], other = regions[face->neighbor(i)];
        sides.push_back(left ? std::array{one, other} : std::array{other, one});
        ++votes[sides.back()[0]];
        --votes[sides.back()[1]];
    }
    std::vector<std::uint32_t> found;
    for (std::uint32_t s = 0; s < sides.size(); ++s)
        if (votes[sides[s][0]] <= 0 || votes[sides[s][1]] >= 0) found.push_back(s);
    return found;
}

std::optional<std::vector<Face>> triangulate(const Outline& outline)
{
    if (outline.segment.size() < 3) return {};
    Triangulation triangulation;
    std::vector<VertexHandle> vertex; // one a point
    try {
        if (!insert(outline, triangulation, vertex)) return {};
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        return {};
    }
    for (const auto face : triangulation.all_face_handles())
        face->info() = Side::Unknown;
    if (!mark_along_segments(outline, vertex, triangulation) || !spread_marks(triangulation)) return {};
    return inside_faces(triangulation);
}

} // namespace quoin
