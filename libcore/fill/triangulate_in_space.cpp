#include "fill/patch.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>

#include <algorithm>

namespace quoin {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::vector<Kernel::Point_3> to_points(const std::vector<Eigen::Vector3d>& positions)
{
    std::vector<Kernel::Point_3> points;
    for (const auto& p : positions)
        points.emplace_back(p.x(), p.y(), p.z());
    return points;
}

} // namespace

std::optional<std::vector<Face>> triangulate_in_space(const Outline& outline,
                                                      const std::vector<Eigen::Vector3d>& beside)
{
    std::vector<CGAL::Triple<int, int, int>> triangles;
    CGAL::Polygon_mesh_processing::triangulate_hole_polyline(to_points(outline.position), to_points(beside),
                                                             std::back_inserter(triangles));
    std::vector<Face> faces;
    for (const auto& t : triangles)
        faces.push_back({outline.vertex[static_cast<std::size_t>(t.first)],
                         outline.vertex[static_cast<std::size_t>(t.second)],
                         outline.vertex[static_cast<std::size_t>(t.third)]});
    if (faces.size() + 2 != outline.vertex.size()) return std::nullopt;
    // Faces run along the outline, whichever way CGAL turns them.
    const auto runs_along = [&](const Face& f, int k) {
        return f[static_cast<std::size_t>(k)] == outline.vertex[0] &&
               f[static_cast<std::size_t>((k + 1) % 3)] == outline.vertex[1];
    };
    const bool along = std::ranges::any_of(
        faces, [&](const Face& f) { return runs_along(f, 0) || runs_along(f, 1) || runs_along(f, 2); });
    if (!along)
        for (Face& f : faces)
            std::swap(f[1], f[2]);
    return faces;
}

} // namespace quoin
