#include "simplify/parts.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace quoin {
namespace {

// Roots of the sets of faces that hang together over edges inside their plane, one a face.
std::vector<FaceId> connected_parts(const PlaneMesh& mesh)
{
    UnionFind parts(mesh.mesh.face.size());
    const auto opposite = opposite_half_edges(mesh.mesh);
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        const std::uint32_t o = opposite[h];
        if (o == kBorderEdge || o == kNonManifoldEdge || mesh.face_plane[o / 3] != mesh.face_plane[h / 3]) continue;
        const std::uint32_t a = parts.find(h / 3), b = parts.find(o / 3);
        if (a != b) parts.join(std::min(a, b), std::max(a, b));
    }
    std::vector<FaceId> root(mesh.mesh.face.size());
    for (FaceId f = 0; f < root.size(); ++f)
        root[f] = parts.find(f);
    return root;
}

// Of every plane the root of its largest part.
std::vector<FaceId> largest_parts(const PlaneMesh& mesh, const std::vector<FaceId>& root)
{
    std::vector<double> area(root.size(), 0.0); // of a part, at its root
    for (FaceId f = 0; f < root.size(); ++f)
        area[root[f]] += face_area(mesh.mesh, f);
    std::vector<FaceId> largest(mesh.plane.size(), 0);
    std::vector<double> most(mesh.plane.size(), -1.0);
    for (FaceId f = 0; f < root.size(); ++f) {
        const PlaneId p = mesh.face_plane[f];
        if (root[f] != f || area[f] <= most[p]) continue;
        most[p] = area[f];
        largest[p] = f;
    }
    return largest;
}

bool explains(const PlaneMesh& mesh, const Plane& plane, const std::vector<FaceId>& faces, double distance)
{
    return std::all_of(faces.begin(), faces.end(), [&](FaceId f) {
        for (int k = 0; k < 3; ++k)
            if (std::abs(plane.signed_distance(corner(mesh.mesh, f, k))) > distance) return false;
        return area_vector(mesh.mesh, f).dot(plane.normal) >= 0.0;
    });
}

// The plane behind the longest border of a part that explains it; a new one, with the moments of the faces, if none
// does.
PlaneId plane_for(PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite, const std::vector<FaceId>& part,
                  double distance)
{
    const PlaneId own = mesh.face_plane[part[0]];
    std::map<PlaneId, double> border;
    for (const FaceId f : part)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t o = opposite[3 * f + k];
            if (o == kBorderEdge || o == kNonManifoldEdge || mesh.face_plane[o / 3] == own) continue;
            border[mesh.face_plane[o / 3]] +=
                (corner(mesh.mesh, f, static_cast<int>((k + 1) % 3)) - corner(mesh.mesh, f, static_cast<int>(k)))
                    .norm();
        }
    std::optional<PlaneId> best;
    for (const auto& [plane, length] : border)
        if (explains(mesh, mesh.plane[plane], part, distance) && (!best || length > border[*best])) best = plane;
    if (best) return *best;
    mesh.plane.push_back(Plane(mesh.plane[own]));
    mesh.moments.emplace_back();
    for (const FaceId f : part)
        mesh.moments.back() +=
            triangle_moments(corner(mesh.mesh, f, 0), corner(mesh.mesh, f, 1), corner(mesh.mesh, f, 2));
    return static_cast<PlaneId>(mesh.plane.size() - 1);
}

} // namespace

void separate_parts(PlaneMesh& mesh, double distance)
{
    const auto root = connected_parts(mesh);
    const auto largest = largest_parts(mesh, root);
    std::map<FaceId, std::vector<FaceId>> parts; // by root
    for (FaceId f = 0; f < root.size(); ++f)
        if (root[f] != largest[mesh.face_plane[f]]) parts[root[f]].push_back(f);
    if (parts.empty()) return;
    const auto opposite = opposite_half_edges(mesh.mesh);
    for (const auto& [_, part] : parts) {
        const PlaneId plane = plane_for(mesh, opposite, part, distance);
        for (const FaceId f : part)
            mesh.face_plane[f] = plane;
    }
}

} // namespace quoin
