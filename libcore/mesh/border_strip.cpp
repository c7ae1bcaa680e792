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

// New names of the vertices that some faces use, in their old order; `used` lists them.
std::vector<VertexId> name_vertices(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                    std::vector<VertexId>& used)
{
    std::vector<VertexId> name(mesh.position.size(), 0);
    for (const FaceId f : faces)
        for (const VertexId v : mesh.face[f])
            name[v] = 1;
    for (VertexId v = 0; v < name.size(); ++v) {
        if (name[v] == 0) continue;
        name[v] = static_cast<VertexId>(used.size());
        used.push_back(v);
    }
    return name;
}

} // namespace

BorderStrip border_strip(const PlaneMesh& mesh)
{
    BorderStrip strip;
    strip.face = faces_on_borders(mesh);
    const std::vector<VertexId> name = name_vertices(mesh.mesh, strip.face, strip.vertex);
    strip.mesh.position.resize(strip.vertex.size());
    strip.mesh.face.resize(strip.face.size());
    strip.face_plane.resize(strip.face.size());
    parallel_for(
        strip.vertex.size(), [&](std::size_t v) { strip.mesh.position[v] = mesh.mesh.position[strip.vertex[v]]; },
        kStripGrain);
    parallel_for(
        strip.face.size(),
        [&](std::size_t f) {
            for (std::size_t k = 0; k < 3; ++k)
                strip.mesh.face[f][k] = name[mesh.mesh.face[strip.face[f]][k]];
            strip.face_plane[f] = mesh.face_plane[strip.face[f]];
        },
        kStripGrain);
    strip.opposite = opposite_half_edges(strip.mesh);
    const auto inner = [&](VertexId v) { return mesh.vertex_class[strip.vertex[v]] == VertexClass::Inner; };
    parallel_for(
        strip.opposite.size(),
        [&](std::size_t h) {
            const Face& face = strip.mesh.face[h / 3];
            if (inner(face[h % 3]) || inner(face[(h % 3 + 1) % 3])) strip.opposite[h] = static_cast<std::uint32_t>(h);
        },
        kStripGrain);
    return strip;
}

} // namespace quoin
