#include "fill/patch.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <deque>

namespace quoin {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr int kUnknown = -1; // crossings of outlines between a face and the outside
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexId, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

struct PlaneFrame {
    Eigen::Vector3d u, v; // v = normal x u
    explicit PlaneFrame(const Plane& plane) : u(plane.normal.unitOrthogonal()), v(plane.normal.cross(u)) {}
    Kernel::Point_2 flat(const Eigen::Vector3d& p) const { return {u.dot(p), v.dot(p)}; }
};

using Handles = std::vector<Triangulation::Vertex_handle>;

// Empty when two vertices of the outlines fall together; throws when outlines cross.
Handles insert(Triangulation& triangulation, const Outline& outline, const PlaneFrame& frame)
{
    Handles handle;
    for (std::size_t i = 0; i < outline.vertex.size(); ++i) {
        const std::size_t before = triangulation.number_of_vertices();
        handle.push_back(triangulation.insert(frame.flat(outline.position[i])));
        if (triangulation.number_of_vertices() == before) return {};
        handle.back()->info() = outline.vertex[i];
    }
    for (std::size_t i = 0; i < handle.size(); ++i)
        triangulation.insert_constraint(handle[i], handle[(i + 1) % handle.size()]);
    return handle;
}

// False when a vertex lies on an edge of an outline and has cut it.
bool keeps_edges(const Triangulation& triangulation, const Handles& handle)
{
    for (std::size_t i = 0; i < handle.size(); ++i)
        if (!triangulation.is_edge(handle[i], handle[(i + 1) % handle.size()])) return false;
    return !handle.empty();
}

// Counts for every face how many outlines separate it from the outside.
void count_crossings(Triangulation& triangulation)
{
    for (auto face : triangulation.all_face_handles())
        face->info() = kUnknown;
    std::deque<Triangulation::Face_handle> queue{triangulation.infinite_face()};
    triangulation.infinite_face()->info() = 0;
    while (!queue.empty()) {
        const auto face = queue.front();
        queue.pop_front();
        for (int k = 0; k < 3; ++k) {
            const auto next = face->neighbor(k);
            if (next->info() != kUnknown) continue;
            const bool crosses = triangulation.is_constrained({face, k});
            next->info() = face->info() + (crosses ? 1 : 0);
            crosses ? queue.push_back(next) : queue.push_front(next); // fewest crossings first
        }
    }
}

} // namespace

std::optional<std::vector<Face>> triangulate_on_plane(const Outline& outline, const std::vector<Outline>& islands,
                                                      const Plane& plane)
{
    const PlaneFrame frame(plane);
    if (outline.vertex.size() < 3 || signed_area(outline, plane.normal) <= 0.0) return std::nullopt;
    Triangulation triangulation;
    try {
        std::vector<Handles> outlines{insert(triangulation, outline, frame)};
        for (const Outline& island : islands)
            outlines.push_back(insert(triangulation, island, frame));
        for (const Handles& handles : outlines)
            if (!keeps_edges(triangulation, handles)) return std::nullopt;
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        return std::nullopt;
    }
    count_crossings(triangulation);
    std::vector<Face> faces;
    for (auto face : triangulation.finite_face_handles())
        if (face->info() % 2 == 1)
            faces.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    if (faces.empty()) return std::nullopt;
    return faces;
}

} // namespace quoin
