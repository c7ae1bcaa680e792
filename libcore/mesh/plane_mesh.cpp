#include "mesh/plane_mesh.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <atomic>

namespace quoin {

void BorderUse::see(PlaneId p)
{
    if (plane[0] == p || plane[1] == p) return;
    if (plane[0] == kNoPlane)
        plane[0] = p;
    else if (plane[1] == kNoPlane)
        plane[1] = p;
    else
        irregular = true;
}

void BorderUse::add_edge(PlaneId here, PlaneId there)
{
    ++edges;
    see(here);
    if (there == kNoPlane)
        mesh_border = true;
    else
        see(there);
}

VertexClass BorderUse::vertex_class() const
{
    if (edges == 0 && !irregular && plane[1] == kNoPlane) return VertexClass::Inner;
    const bool crease_meets_border = mesh_border && plane[1] != kNoPlane;
    return edges == 2 && !irregular && !crease_meets_border ? VertexClass::Border : VertexClass::Corner;
}

namespace {

constexpr std::size_t kFaceGrain = 1 << 14;

// Is the edge one of a plane's border or of the mesh's?
bool on_curve(const std::vector<PlaneId>& face_plane, std::uint32_t half_edge, std::uint32_t opposite)
{
    return !is_half_edge(opposite) || face_plane[opposite / 3] != face_plane[half_edge / 3];
}

// Several threads may store the same or, where any will do, different values.
template <class T>
void store(T& place, T value)
{
    std::atomic_ref(place).store(value, std::memory_order_relaxed);
}

// A half-edge that lies on a curve, at the uses of its ends.
void see_curve(BorderUse& a, BorderUse& b, const std::vector<PlaneId>& face_plane, std::uint32_t half_edge,
               std::uint32_t opposite)
{
    if (opposite == kNonManifoldEdge) a.irregular = b.irregular = true;
    if (opposite == kNonManifoldEdge || opposite < half_edge) return; // the other half-edge counts
    for (BorderUse* end : {&a, &b})
        end->add_edge(face_plane[half_edge / 3], opposite == kBorderEdge ? kNoPlane : face_plane[opposite / 3]);
}

// 1 for the vertices that are on a curve or touch more than one plane.
std::vector<std::uint8_t> not_inside_planes(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane,
                                            const std::vector<std::uint32_t>& opposite)
{
    std::vector<std::uint8_t> found(mesh.position.size(), 0);
    std::vector<PlaneId> some_plane(mesh.position.size());
    const auto see_curves = [&](std::size_t f) {
        const Face& face = mesh.face[f];
        for (std::uint32_t k = 0; k < 3; ++k) {
            store(some_plane[face[k]], face_plane[f]);
            const auto h = static_cast<std::uint32_t>(3 * f + k);
            if (!on_curve(face_plane, h, opposite[h])) continue;
            store(found[face[k]], std::uint8_t{1});
            store(found[face[(k + 1) % 3]], std::uint8_t{1});
        }
    };
    const auto see_other_planes = [&](std::size_t f) {
        for (const VertexId v : mesh.face[f])
            if (some_plane[v] != face_plane[f]) store(found[v], std::uint8_t{1});
    };
    parallel_for(mesh.face.size(), see_curves, kFaceGrain);
    parallel_for(mesh.face.size(), see_other_planes, kFaceGrain);
    return found;
}

} // namespace

std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane)
{
    return classify_vertices(mesh, face_plane, opposite_half_edges(mesh));
}

std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane,
                                           const std::vector<std::uint32_t>& opposite)
{
    const auto doubtful = not_inside_planes(mesh, face_plane, opposite);
    std::vector<std::uint32_t> place(mesh.position.size()); // in `use`, of doubtful vertices
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < place.size(); ++v)
        place[v] = doubtful[v] ? count++ : 0;
    std::vector<BorderUse> use(count);
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        const Face& face = mesh.face[f];
        if (!doubtful[face[0]] && !doubtful[face[1]] && !doubtful[face[2]]) continue;
        for (std::uint32_t k = 0; k < 3; ++k) {
            if (doubtful[face[k]]) use[place[face[k]]].see(face_plane[f]);
            const std::uint32_t h = 3 * f + k;
            if (on_curve(face_plane, h, opposite[h]))
                see_curve(use[place[face[k]]], use[place[face[(k + 1) % 3]]], face_plane, h, opposite[h]);
        }
    }
    std::vector<VertexClass> classes(mesh.position.size(), VertexClass::Inner);
    for (std::size_t v = 0; v < classes.size(); ++v)
        if (doubtful[v]) classes[v] = use[place[v]].vertex_class();
    return classes;
}

} // namespace quoin
