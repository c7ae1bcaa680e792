#include "simplify/chords.h"

#include <algorithm>

namespace quoin {
namespace {

bool holds(std::span<const PlaneId> planes, PlaneId plane)
{
    return std::binary_search(planes.begin(), planes.end(), plane);
}
bool has(const Face& face, VertexId v) { return face[0] == v || face[1] == v || face[2] == v; }

} // namespace

Chords::Chords(const PlaneMesh& mesh)
    : mesh_(mesh), around_(vertex_faces(mesh.mesh)), planes_(vertex_planes(mesh.mesh, mesh.face_plane))
{
}

bool Chords::may_join(PlaneId plane, VertexId a, VertexId b) const
{
    for (const PlaneId p : planes_.of(a))
        if (p < plane && holds(planes_.of(b), p)) return false;
    const auto faces = around_.of(a);
    return std::none_of(faces.begin(), faces.end(), [&](FaceId f) { return has(mesh_.mesh.face[f], b); });
}

bool Chords::may_fill(PlaneId plane, const Face& face) const
{
    for (const PlaneId p : planes_.of(face[0]))
        if (p < plane && holds(planes_.of(face[1]), p) && holds(planes_.of(face[2]), p)) return false;
    const auto faces = around_.of(face[0]);
    return std::none_of(faces.begin(), faces.end(),
                        [&](FaceId f) { return has(mesh_.mesh.face[f], face[1]) && has(mesh_.mesh.face[f], face[2]); });
}

bool Chords::inside(PlaneId plane, VertexId a, VertexId b) const
{
    const auto faces = around_.of(a);
    return std::all_of(faces.begin(), faces.end(),
                       [&](FaceId f) { return mesh_.face_plane[f] == plane || !has(mesh_.mesh.face[f], b); });
}

} // namespace quoin
