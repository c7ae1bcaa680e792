#include "mesh/adjacency.h"

#include "geometry/union_find.h"

#include <algorithm>

namespace quoin {
namespace {

struct EdgeKey {
    std::uint64_t vertices; // smaller id in the high half
    std::uint32_t half_edge;
};

// Sorts by key with a stable radix sort of 11-bit digits over the bits that vertex ids use.
void radix_sort(std::vector<EdgeKey>& keys, std::size_t vertex_count)
{
    int bits = 1;
    while ((std::size_t{1} << bits) < vertex_count) ++bits;
    std::vector<EdgeKey> buffer(keys.size());
    for (const int base : {0, 32}) {
        for (int shift = base; shift < base + bits; shift += 11) {
            std::array<std::size_t, 2049> count{};
            const auto digit = [&](const EdgeKey& key) { return (key.vertices >> shift) & 2047u; };
            for (const auto& key : keys) ++count[digit(key) + 1];
            for (std::size_t i = 1; i < count.size(); ++i) count[i] += count[i - 1];
            for (const auto& key : keys) buffer[count[digit(key)]++] = key;
            keys.swap(buffer);
        }
    }
}

std::vector<EdgeKey> sorted_edges(const TriangleMesh& mesh)
{
    std::vector<EdgeKey> keys(3 * mesh.face.size());
    for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(mesh.face[f][k], mesh.face[f][(k + 1) % 3]);
            keys[3 * f + k] = {(std::uint64_t{low} << 32) | high, static_cast<std::uint32_t>(3 * f + k)};
        }
    }
    radix_sort(keys, mesh.position.size());
    return keys;
}

} // namespace

std::vector<std::uint32_t> opposite_half_edges(const TriangleMesh& mesh)
{
    const auto keys = sorted_edges(mesh);
    std::vector<std::uint32_t> opposite(keys.size(), kBorderEdge);
    for (std::size_t begin = 0; begin < keys.size();) {
        std::size_t end = begin + 1;
        while (end < keys.size() && keys[end].vertices == keys[begin].vertices) ++end;
        if (end - begin == 2) {
            opposite[keys[begin].half_edge] = keys[begin + 1].half_edge;
            opposite[keys[begin + 1].half_edge] = keys[begin].half_edge;
        } else if (end - begin > 2) {
            for (std::size_t i = begin; i < end; ++i) opposite[keys[i].half_edge] = kNonManifoldEdge;
        }
        begin = end;
    }
    return opposite;
}

VertexFaces vertex_faces(const TriangleMesh& mesh)
{
    VertexFaces around;
    around.first.assign(mesh.position.size() + 1, 0);
    for (const auto& face : mesh.face)
        for (const VertexId v : face) ++around.first[v + 1];
    for (std::size_t v = 0; v < mesh.position.size(); ++v) around.first[v + 1] += around.first[v];
    around.face.resize(3 * mesh.face.size());
    std::vector<std::uint32_t> next(around.first.begin(), around.first.end() - 1);
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        for (const VertexId v : mesh.face[f]) around.face[next[v]++] = f;
    return around;
}

std::vector<std::uint32_t> face_components(const TriangleMesh& mesh)
{
    const auto keys = sorted_edges(mesh);
    UnionFind sets(mesh.face.size());
    for (std::size_t i = 1; i < keys.size(); ++i) {
        if (keys[i].vertices != keys[i - 1].vertices) continue;
        const std::uint32_t a = sets.find(keys[i].half_edge / 3), b = sets.find(keys[i - 1].half_edge / 3);
        if (a != b) sets.join(std::min(a, b), std::max(a, b));
    }
    std::vector<std::uint32_t> component(mesh.face.size());
    std::uint32_t count = 0;
    for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
        const std::uint32_t root = sets.find(f);
        component[f] = root == f ? count++ : component[root];
    }
    return component;
}

} // namespace quoin
