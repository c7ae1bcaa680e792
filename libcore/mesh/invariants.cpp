#include "mesh/invariants.h"

#include "mesh/hygiene.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>

namespace quoin {
namespace {

std::string broken_promise_of_labels(const PlaneMesh& mesh)
{
    const std::size_t faces = mesh.mesh.face.size(), planes = mesh.plane.size();
    if (mesh.face_plane.size() != faces) return fmt::format("{} labels for {} faces", mesh.face_plane.size(), faces);
    if (mesh.moments.size() != planes) return fmt::format("{} moments for {} planes", mesh.moments.size(), planes);
    if (mesh.vertex_class.size() != mesh.mesh.position.size())
        return fmt::format("{} classes for {} vertices", mesh.vertex_class.size(), mesh.mesh.position.size());
    std::vector<std::uint8_t> used(planes, 0);
    for (const PlaneId p : mesh.face_plane) {
        if (p >= planes) return fmt::format("a face of plane {} of {}", p, planes);
        used[p] = 1;
    }
    const auto empty = std::ranges::find(used, 0);
    return empty == used.end() ? "" : fmt::format("plane {} has no face", empty - used.begin());
}

bool repeats_vertex(const Face& face) { return face[0] == face[1] || face[1] == face[2] || face[2] == face[0]; }

} // namespace

std::string broken_promise_of_planes(const PlaneMesh& mesh)
{
    std::string broken = broken_promise_of_labels(mesh);
    if (!broken.empty() || std::ranges::any_of(mesh.mesh.face, repeats_vertex)) return broken;
    const std::size_t count = inspect(mesh).disconnected_planes;
    return count == 0 ? "" : fmt::format("{} planes are in pieces", count);
}

std::string broken_promise_of_light_mesh(const PlaneMesh& mesh)
{
    std::string broken = broken_promise_of_planes(mesh);
    if (!broken.empty()) return broken;
    const Hygiene found = inspect(mesh);
    for (const auto& [count, name] : {std::pair(found.non_manifold_edges, "edges of three or more faces"),
                                      {found.bow_tie_vertices, "bow-ties"},
                                      {found.duplicate_faces, "repeated faces"},
                                      {found.isolated_vertices, "isolated vertices"},
                                      {found.flipped_faces, "faces that look away from their plane"}})
        if (count > 0) return fmt::format("{} {}", count, name);
    return "";
}

} // namespace quoin
