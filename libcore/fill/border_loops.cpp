#include "fill/border_loops.h"

#include "mesh/adjacency.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

namespace quoin {
namespace {

std::uint32_t next_in_face(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }

VertexId start_of(const TriangleMesh& mesh, std::uint32_t h) { return mesh.face[h / 3][h % 3]; }

// The border edge that follows h in the fan of faces around its end; none at a non-manifold or misoriented edge.
std::optional<std::uint32_t> next_on_border(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                            std::uint32_t h)
{
    const VertexId around = start_of(mesh, next_in_face(h));
    std::uint32_t g = next_in_face(h);
    while (opposite[g] != kBorderEdge) {
        if (opposite[g] == kNonManifoldEdge) return std::nullopt;
        g = next_in_face(opposite[g]);
        if (start_of(mesh, g) != around) return std::nullopt;
    }
    return g;
}

// Half-edges of the whole border that holds `first`, in the direction of their faces; empty when it does not close.
std::vector<std::uint32_t> trace(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                 std::uint32_t first, std::vector<bool>& visited)
{
    std::vector<std::uint32_t> chain;
    for (std::uint32_t h = first;;) {
        if (visited[h]) return {};
        visited[h] = true;
        chain.push_back(h);
        const auto next = next_on_border(mesh, opposite, h);
        if (!next) return {};
        if (*next == first) return chain;
        h = *next;
    }
}

// Cuts a closed chain where it comes back to a vertex, and turns the pieces into the direction of closing faces.
void add_simple_loops(const PlaneMesh& mesh, const std::vector<std::uint32_t>& chain, std::vector<BorderLoop>& loops)
{
    std::vector<std::uint32_t> open;
    std::unordered_map<VertexId, std::size_t> position; // of the edge in `open` that starts at a vertex
    const auto close_from = [&](std::size_t begin) {
        BorderLoop loop;
        for (std::size_t i = open.size(); i-- > begin;) {
            loop.vertex.push_back(start_of(mesh.mesh, next_in_face(open[i])));
            loop.plane.push_back(mesh.face_plane[open[i] / 3]);
            loop.face.push_back(open[i] / 3);
        }
        for (std::size_t i = begin; i < open.size(); ++i)
            position.erase(start_of(mesh.mesh, open[i]));
        open.resize(begin);
        if (loop.vertex.size() >= 3) loops.push_back(std::move(loop));
    };
    for (const std::uint32_t h : chain) {
        position[start_of(mesh.mesh, h)] = open.size();
        open.push_back(h);
        const auto back = position.find(start_of(mesh.mesh, next_in_face(h)));
        if (back != position.end()) close_from(back->second);
    }
}

} // namespace

std::vector<BorderLoop> border_loops(const PlaneMesh& mesh)
{
    const auto opposite = opposite_half_edges(mesh.mesh);
    std::vector<bool> visited(opposite.size(), false);
    std::vector<BorderLoop> loops;
    for (std::uint32_t h = 0; h < opposite.size(); ++h)
        if (opposite[h] == kBorderEdge && !visited[h])
            add_simple_loops(mesh, trace(mesh.mesh, opposite, h, visited), loops);
    return loops;
}

} // namespace quoin
