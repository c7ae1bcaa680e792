#include "mesh/plane_mesh.h"

#include "mesh/adjacency.h"

#include <algorithm>

namespace quoin {
namespace {

// What a vertex has seen while half-edges are walked.
struct Seen {
    PlaneId plane[2] = {kNoPlane, kNoPlane};
    bool more_planes = false;
    int curve_edges = 0; // edges of plane borders and mesh borders that end here
    bool irregular = false;
};

void see_plane(Seen& seen, PlaneId plane)
{
    if (seen.plane[0] == plane || seen.plane[1] == plane) return;
    if (seen.plane[0] == kNoPlane)
        seen.plane[0] = plane;
    else if (seen.plane[1] == kNoPlane)
        seen.plane[1] = plane;
    else
        seen.more_planes = true;
}

VertexClass class_of(const Seen& seen)
{
    const bool regular_curve = seen.curve_edges == 2 && !seen.irregular && !seen.more_planes;
    if (seen.curve_edges == 0 && !seen.irregular && seen.plane[1] == kNoPlane) return VertexClass::Inner;
    return regular_curve ? VertexClass::Border : VertexClass::Corner;
}

} // namespace

std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane)
{
    return classify_vertices(mesh, face_plane, opposite_half_edges(mesh));
}

std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane,
                                           const std::vector<std::uint32_t>& opposite)
{
    std::vector<Seen> seen(mesh.position.size());
    std::vector<std::uint8_t> mesh_border(mesh.position.size(), 0);
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        const FaceId f = h / 3;
        const VertexId a = mesh.face[f][h % 3], b = mesh.face[f][(h % 3 + 1) % 3];
        see_plane(seen[a], face_plane[f]);
        if (opposite[h] == kNonManifoldEdge) {
            seen[a].irregular = seen[b].irregular = true;
            continue;
        }
        const bool on_mesh_border = opposite[h] == kBorderEdge;
        const bool first_of_pair = !on_mesh_border && h < opposite[h];
        if (on_mesh_border || (first_of_pair && face_plane[opposite[h] / 3] != face_plane[f])) {
            ++seen[a].curve_edges;
            ++seen[b].curve_edges;
        }
        if (on_mesh_border) mesh_border[a] = mesh_border[b] = 1;
    }
    std::vector<VertexClass> classes(mesh.position.size());
    for (std::size_t v = 0; v < seen.size(); ++v) {
        if (mesh_border[v] && seen[v].plane[1] != kNoPlane)
            seen[v].irregular = true; // where a crease meets the mesh border
        classes[v] = class_of(seen[v]);
    }
    return classes;
}

} // namespace quoin
