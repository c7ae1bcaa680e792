#include "mesh/adjacency.h"

#include "base/parallel.h"
#include "geometry/union_find.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr std::size_t kVertexGrain = 1 << 14; // [vertices]
constexpr std::size_t kFaceGrain = 1 << 14;   // [faces]

// The half-edges of every edge, by its smaller vertex. Meshes are in Morton order, so that a bucket's half-edges lie
// near each other in memory; sorting keys of all edges costs several times as much.
struct EdgeBuckets {
    std::vector<std::uint32_t> first; // V + 1
    std::vector<std::uint32_t> half_edge;

    explicit EdgeBuckets(const TriangleMesh& mesh) : first(mesh.position.size() + 1, 0), half_edge(3 * mesh.face.size())
    {
        for (const auto& [a, b, c] : mesh.face)
            for (const VertexId low : {std::min(a, b), std::min(b, c), std::min(c, a)})
                ++first[low + 1];
        for (std::size_t v = 0; v + 1 < first.size(); ++v)
            first[v + 1] += first[v];
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        std::uint32_t h = 0;
        for (const auto& [a, b, c] : mesh.face)
            for (const VertexId low : {std::min(a, b), std::min(b, c), std::min(c, a)})
                half_edge[next[low]++] = h++;
    }
};

struct EdgeEnd {
    VertexId high = 0;
    std::uint32_t half_edge = 0;
    auto operator<=>(const EdgeEnd&) const = default;
};

// Ascending. Buckets hold a few edges, for which insertion beats std::sort.
void sort_few(std::vector<EdgeEnd>& ends)
{
    constexpr std::size_t kFew = 32;
    if (ends.size() > kFew) return std::sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i) {
        const EdgeEnd end = ends[i];
        std::size_t hole = i;
        for (; hole > 0 && end < ends[hole - 1]; --hole)
            ends[hole] = ends[hole - 1];
        ends[hole] = end;
    }
}

// Calls visit(first, last) for the half-edges of every edge whose smaller vertex is in [begin, end), ascending.
template <class Visit>
void for_each_edge(const TriangleMesh& mesh, const EdgeBuckets& buckets, std::size_t begin, std::size_t end,
                   const Visit& visit)
{
    std::vector<EdgeEnd> ends;
    for (std::size_t v = begin; v < end; ++v) {
        ends.clear();
        for (std::uint32_t i = buckets.first[v]; i < buckets.first[v + 1]; ++i) {
            const std::uint32_t h = buckets.half_edge[i];
            ends.push_back({std::max(mesh.face[h / 3][h % 3], mesh.face[h / 3][(h % 3 + 1) % 3]), h});
        }
        sort_few(ends);
        for (std::size_t i = 0, j = 0; i < ends.size(); i = j) {
            for (j = i + 1; j < ends.size() && ends[j].high == ends[i].high;)
                ++j;
            visit(&ends[i], &ends[i] + (j - i));
        }
    }
}

} // namespace

std::vector<std::uint32_t> opposite_half_edges(const TriangleMesh& mesh)
{
    const EdgeBuckets buckets(mesh);
    std::vector<std::uint32_t> opposite(3 * mesh.face.size());
    parallel_chunks(mesh.position.size(), kVertexGrain, [&](std::size_t begin, std::size_t end) {
        for_each_edge(mesh, buckets, begin, end, [&](const EdgeEnd* first, const EdgeEnd* last) {
            const auto faces = last - first;
            if (faces == 1) {
                opposite[first->half_edge] = kBorderEdge;
            } else if (faces == 2) {
                opposite[first[0].half_edge] = first[1].half_edge;
                opposite[first[1].half_edge] = first[0].half_edge;
            } else {
                for (; first != last; ++first)
                    opposite[first->half_edge] = kNonManifoldEdge;
            }
        });
    });
    return opposite;
}

std::vector<FaceId> faces_that_may_repeat(const std::vector<std::uint32_t>& opposite)
{
    return parallel_select<FaceId>(opposite.size() / 3, kFaceGrain, [&](std::size_t f) {
        const std::uint32_t a = opposite[3 * f], b = opposite[3 * f + 1], c = opposite[3 * f + 2];
        if (a == kBorderEdge || b == kBorderEdge || c == kBorderEdge) return false;
        const bool crowded = a == kNonManifoldEdge || b == kNonManifoldEdge || c == kNonManifoldEdge;
        return crowded || (a / 3 == b / 3 && b / 3 == c / 3);
    });
}

VertexFaces vertex_faces(const TriangleMesh& mesh)
{
    VertexFaces around;
    around.first.assign(mesh.position.size() + 1, 0);
    for (const auto& face : mesh.face)
        for (const VertexId v : face)
            ++around.first[v + 1];
    for (std::size_t v = 0; v < mesh.position.size(); ++v)
        around.first[v + 1] += around.first[v];
    around.face.resize(3 * mesh.face.size());
    std::vector<std::uint32_t> next(around.first.begin(), around.first.end() - 1);
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        for (const VertexId v : mesh.face[f])
            around.face[next[v]++] = f;
    return around;
}

std::vector<std::uint32_t> face_components(const TriangleMesh& mesh)
{
    const EdgeBuckets buckets(mesh);
    UnionFind sets(mesh.face.size());
    for_each_edge(mesh, buckets, 0, mesh.position.size(), [&](const EdgeEnd* first, const EdgeEnd* last) {
        for (; first + 1 < last; ++first) {
            const std::uint32_t a = sets.find(first[0].half_edge / 3), b = sets.find(first[1].half_edge / 3);
            if (a != b) sets.join(std::min(a, b), std::max(a, b));
        }
    });
    std::vector<std::uint32_t> component(mesh.face.size());
    std::uint32_t count = 0;
    for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
        const std::uint32_t root = sets.find(f);
        component[f] = root == f ? count++ : component[root];
    }
    return component;
}

} // namespace quoin
