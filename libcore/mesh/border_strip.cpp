#include "mesh/border_strip.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr std::size_t kStripGrain = 1 << 14; // [faces]

std::vector<FaceId> faces_on_borders(const PlaneMesh& mesh)
{
    const auto on_border = [&](VertexId v) { return mesh.vertex_class[v] != VertexClass::Inner; };
    const auto found_in = [&](std::size_t begin, std::size_t end) {
        std::vector<FaceId> found;
        for (std::size_t f = begin; f < end; ++f)
            if (std::ranges::any_of(mesh.mesh.face[f], on_border)) found.push_back(static_cast<FaceId>(f));
        return found;
    };
    const auto append = [](std::vector<FaceId> all, const std::vector<FaceId>& more) {
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    return parallel_reduce(mesh.mesh.face.size(), kStripGrain, std::vector<FaceId>(), found_in, append);
}

} // namespace

BorderStrip border_strip(const PlaneMesh& mesh)
{
    constexpr VertexId kUnnamed = 0xffffffffu;
    BorderStrip strip;
    strip.face = faces_on_borders(mesh);
    std::vector<VertexId> name(mesh.mesh.position.size(), kUnnamed);
    for (const FaceId f : strip.face) {
        Face face = mesh.mesh.face[f];
        for (VertexId& v : face) {
            if (name[v] == kUnnamed) {
                name[v] = static_cast<VertexId>(strip.vertex.size());
                strip.vertex.push_back(v);
                strip.mesh.position.push_back(mesh.mesh.position[v]);
            }
            v = name[v];
        }
        strip.mesh.face.push_back(face);
        strip.face_plane.push_back(mesh.face_plane[f]);
    }
    strip.opposite = opposite_half_edges(strip.mesh);
    const auto inner = [&](VertexId v) { return mesh.vertex_class[strip.vertex[v]] == VertexClass::Inner; };
    for (std::uint32_t h = 0; h < strip.opposite.size(); ++h) {
        const Face& face = strip.mesh.face[h / 3];
        if (inner(face[h % 3]) || inner(face[(h % 3 + 1) % 3])) strip.opposite[h] = h;
    }
    return strip;
}

} // namespace quoin
