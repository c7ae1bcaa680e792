#include "mesh/plane_mesh.h"

#include "mesh/adjacency.h"

#include <algorithm>

namespace quoin {

void BorderUse::add(PlaneId here, PlaneId there)
{
    ++edges;
    mesh_border = mesh_border || there == kNoPlane;
    for (const PlaneId p : {here, there}) {
        if (p == kNoPlane || plane[0] == p || plane[1] == p) continue;
        if (plane[0] == kNoPlane)
            plane[0] = p;
        else if (plane[1] == kNoPlane)
            plane[1] = p;
        else
            irregular = true;
    }
}

VertexClass BorderUse::vertex_class() const
{
    if (edges == 0 && !irregular) return VertexClass::Inner;
    const bool crease_meets_border = mesh_border && plane[1] != kNoPlane;
    return edges == 2 && !irregular && !crease_meets_border ? VertexClass::Border : VertexClass::Corner;
}

std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane)
{
    return classify_vertices(mesh, face_plane, opposite_half_edges(mesh));
}

std::vector<VertexClass> classify_vertices(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane,
                                           const std::vector<std::uint32_t>& opposite)
{
    std::vector<BorderUse> use(mesh.position.size());
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        const std::uint32_t o = opposite[h];
        const PlaneId here = face_plane[h / 3];
        if (is_half_edge(o) && (o < h || face_plane[o / 3] == here)) continue;
        for (const std::uint32_t k : {h % 3, (h % 3 + 1) % 3}) {
            BorderUse& end = use[mesh.face[h / 3][k]];
            if (o == kNonManifoldEdge)
                end.irregular = true;
            else
                end.add(here, o == kBorderEdge ? kNoPlane : face_plane[o / 3]);
        }
    }
    std::vector<VertexClass> classes(use.size());
    for (std::size_t v = 0; v < use.size(); ++v)
        classes[v] = use[v].vertex_class();
    return classes;
}

} // namespace quoin
