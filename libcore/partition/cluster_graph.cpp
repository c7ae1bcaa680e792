#include "partition/cluster_graph.h"

#include "base/parallel.h"
#include "geometry/pca_energy.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace quoin {
namespace {

constexpr std::size_t kClusterGrain = 16384;
constexpr std::size_t kBlockFaces = 16384; // their clusters and edges take about as much as a second-level cache
constexpr std::uint32_t kUnnumbered = 0xffffffffu;
// Faces of a non-manifold edge are linked to this many of their successors; farther ones are neighbours through those.
constexpr std::size_t kFanReach = 8;

Cluster cluster_of_face(const TriangleMesh& mesh, FaceId f, const Eigen::Vector3d& origin)
{
    const Eigen::Vector3d a = corner(mesh, f, 0) - origin, b = corner(mesh, f, 1) - origin,
                          c = corner(mesh, f, 2) - origin;
    // The energy of a single face is zero: it is flat.
    return {triangle_moments(a, b, c), 0.0, (0.5 * (b - a).cross(c - a)).cast<float>()};
}

void add_edge(std::vector<ClusterEdge>& edges, ClusterId a, ClusterId b)
{
    if (a != b) edges.push_back({std::min(a, b), std::max(a, b), kUnknownCost});
}

struct FanEdge {
    std::pair<VertexId, VertexId> vertices;
    FaceId face;
    auto operator<=>(const FanEdge&) const = default;
};

void add_fans(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, ClusterGraph& graph)
{
    std::vector<FanEdge> fans;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        if (opposite[h] != kNonManifoldEdge) continue;
        const auto& face = mesh.face[h / 3];
        fans.push_back({std::minmax({face[h % 3], face[(h % 3 + 1) % 3]}), h / 3});
    }
    std::sort(fans.begin(), fans.end());
    for (std::size_t i = 0; i < fans.size(); ++i)
        for (std::size_t j = i + 1; j < fans.size() && j <= i + kFanReach && fans[j].vertices == fans[i].vertices; ++j)
            add_edge(graph.edge, graph.face_cluster[fans[i].face], graph.face_cluster[fans[j].face]);
}

// Keeps one edge of each pair; they are then in the order of their first ends. Of equal edges the one that comes first
// stays.
void drop_doubles(std::vector<ClusterEdge>& edges, std::size_t clusters, EdgeBuffers& buffers)
{
    auto& [next, met, sorted] = buffers;
    next.assign(clusters, 0);
    for (const auto& edge : edges)
        ++next[edge.a];
    std::exclusive_scan(next.begin(), next.end(), next.begin(), 0u);
    sorted.resize(std::max(sorted.size(), edges.size()));
    for (const auto& edge : edges)
        sorted[next[edge.a]++] = edge;
    met.assign(clusters, kUnnumbered); // the first end that was seen last with this second one
    std::size_t kept = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (met[sorted[i].b] == sorted[i].a) continue;
        met[sorted[i].b] = sorted[i].a;
        edges[kept++] = sorted[i];
    }
    edges.resize(kept);
}

Eigen::Vector3d center_of(const TriangleMesh& mesh)
{
    using Box = Eigen::AlignedBox3f;
    const auto box_of = [&](std::size_t begin, std::size_t end) {
        Box box;
        for (std::size_t f = begin; f < end; ++f)
            for (const VertexId v : mesh.face[f])
                box.extend(mesh.position[v]);
        return box;
    };
    const Box box = parallel_reduce(mesh.face.size(), kClusterGrain, Box(), box_of,
                                    [](const Box& x, const Box& y) { return x.merged(y); });
    return box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.center().cast<double>());
}

// Is the cosine between two vectors below the limit?
bool apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double min_cosine)
{
    const double dot = a.dot(b), bound = min_cosine * min_cosine * a.squaredNorm() * b.squaredNorm();
    return min_cosine < 0.0 ? dot < 0.0 && dot * dot > bound : dot < 0.0 || dot * dot < bound;
}

// Is the RMS distance of the union, and of both parts, to the union's plane at most max_error? Planes are fitted only
// where bounds leave it open: the variance of the union lies between those of its invariants, and no part exceeds that
// of the union by more than the ratio of the areas.
bool parts_fit(const Moments& a, const Moments& b, const Moments& sum, const Invariants& i, double max_error)
{
    const double max_variance = max_error * max_error;
    const double smaller = std::min(a.area, b.area);
    if (i.variance_is_below(max_variance * smaller / sum.area)) return true;
    if (i.variance_is_above(max_variance)) return false;
    const double variance = smallest_eigenvalue(sum.central()) / sum.area;
    if (variance > max_variance) return false;
    if (variance * sum.area <= max_variance * smaller) return true;
    const Plane plane = fit_plane(sum);
    return rms_to_plane(a, plane) <= max_error && rms_to_plane(b, plane) <= max_error;
}

// i: the invariants of `sum`, which is a.sum + b.sum.
bool may_join(const Cluster& a, const Cluster& b, const Moments& sum, const Invariants& i, const MergeLimits& limits)
{
    const Eigen::Vector3d x = a.facing.cast<double>(), y = b.facing.cast<double>(), facing = x + y;
    const double least = limits.min_facing * sum.area;
    if (facing.squaredNorm() < least * least) return false;
    if (apart(x, facing, limits.min_part_cosine) || apart(y, facing, limits.min_part_cosine)) return false;
    return !std::isfinite(limits.max_error) || parts_fit(a.sum, b.sum, sum, i, limits.max_error);
}

struct FaceRange {
    std::size_t first = 0, last = 0;
    std::size_t size() const { return last - first; }
};

// Clusters of single faces, still without sums, and the edges between them that are no fans.
ClusterGraph clusters_of_range(const std::vector<std::uint32_t>& opposite, FaceRange range)
{
    ClusterGraph graph;
    graph.count = range.size();
    graph.cluster.resize(graph.count);
    graph.parent.resize(graph.count);
    std::iota(graph.parent.begin(), graph.parent.end(), 0u);
    graph.face_cluster = graph.parent;
    graph.edge.reserve(3 * graph.count / 2);
    for (std::size_t f = range.first; f < range.last; ++f)
        for (std::size_t h = 3 * f; h < 3 * f + 3; ++h)
            if (const std::uint32_t o = opposite[h]; h < o && o < 3 * range.last)
                add_edge(graph.edge, static_cast<ClusterId>(f - range.first),
                         static_cast<ClusterId>(o / 3 - range.first));
    return graph;
}

void sum_faces(const TriangleMesh& mesh, std::size_t first, ClusterGraph& graph)
{
    parallel_for(
        graph.cluster.size(),
        [&](std::size_t c) { graph.cluster[c] = cluster_of_face(mesh, static_cast<FaceId>(first + c), graph.origin); },
        kClusterGrain);
}

// A block keeps what is left of it; the memory of its single faces serves the next one.
void release_spare(ClusterGraph& block)
{
    block.cluster.shrink_to_fit();
    block.edge.shrink_to_fit();
    block.parent.clear();
    block.parent.shrink_to_fit();
}

// Blocks one behind the other; edges between them are still missing. Empties the blocks.
ClusterGraph concatenated(std::vector<ClusterGraph>& blocks, std::size_t faces)
{
    ClusterGraph graph;
    graph.origin = blocks.front().origin;
    graph.limits = blocks.front().limits;
    graph.face_cluster.resize(faces);
    std::vector<ClusterId> offset;
    for (auto& block : blocks) {
        offset.push_back(static_cast<ClusterId>(graph.count));
        graph.cluster.insert(graph.cluster.end(), block.cluster.begin(), block.cluster.end());
        for (const auto& edge : block.edge)
            graph.edge.push_back({edge.a + offset.back(), edge.b + offset.back(), edge.cost});
        graph.count += block.count;
    }
    parallel_for(blocks.size(), [&](std::size_t b) {
        for (std::size_t i = 0; i < blocks[b].face_cluster.size(); ++i)
            graph.face_cluster[b * kBlockFaces + i] = offset[b] + blocks[b].face_cluster[i];
        blocks[b] = {};
    });
    graph.parent.resize(graph.count);
    std::iota(graph.parent.begin(), graph.parent.end(), 0u);
    return graph;
}

void add_edges_between_blocks(const std::vector<std::uint32_t>& opposite, ClusterGraph& graph)
{
    const auto edges_out_of = [&](std::size_t begin, std::size_t end) {
        std::vector<ClusterEdge> edges;
        for (std::size_t f = begin; f < end; ++f)
            for (std::size_t h = 3 * f; h < 3 * f + 3; ++h)
                if (const std::uint32_t o = opposite[h]; o >= 3 * end && is_half_edge(o))
                    add_edge(edges, graph.face_cluster[f], graph.face_cluster[o / 3]);
        return edges;
    };
    const auto append = [](std::vector<ClusterEdge> all, const std::vector<ClusterEdge>& more) {
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const auto edges =
        parallel_reduce(graph.face_cluster.size(), kBlockFaces, std::vector<ClusterEdge>(), edges_out_of, append);
    graph.edge.insert(graph.edge.end(), edges.begin(), edges.end());
}

} // namespace

ClusterGraph clusters_of_faces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                               const MergeLimits& limits)
{
    ClusterGraph graph = clusters_of_range(opposite, {0, mesh.face.size()});
    graph.origin = center_of(mesh);
    graph.limits = limits;
    sum_faces(mesh, 0, graph);
    add_fans(mesh, opposite, graph);
    EdgeBuffers buffers;
    drop_doubles(graph.edge, graph.count, buffers);
    return graph;
}

ClusterGraph clusters_of_blocks(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                const MergeLimits& limits, const std::function<void(ClusterGraph& block)>& grow)
{
    const Eigen::Vector3d origin = center_of(mesh);
    std::vector<ClusterGraph> blocks((mesh.face.size() + kBlockFaces - 1) / kBlockFaces);
    parallel_for(blocks.size(), [&](std::size_t b) {
        const FaceRange range{b * kBlockFaces, std::min((b + 1) * kBlockFaces, mesh.face.size())};
        blocks[b] = clusters_of_range(opposite, range);
        blocks[b].origin = origin;
        blocks[b].limits = limits;
        sum_faces(mesh, range.first, blocks[b]);
        grow(blocks[b]);
        release_spare(blocks[b]);
    });
    ClusterGraph graph = concatenated(blocks, mesh.face.size());
    add_edges_between_blocks(opposite, graph);
    add_fans(mesh, opposite, graph);
    EdgeBuffers buffers;
    drop_doubles(graph.edge, graph.count, buffers);
    return graph;
}

bool may_join(const Cluster& a, const Cluster& b, const MergeLimits& limits)
{
    const Moments sum = a.sum + b.sum;
    return may_join(a, b, sum, invariants(sum), limits);
}

double merge_cost(const ClusterGraph& graph, ClusterId a, ClusterId b)
{
    const Cluster &x = graph.cluster[a], &y = graph.cluster[b];
    const Moments sum = x.sum + y.sum;
    const Invariants i = invariants(sum);
    if (!may_join(x, y, sum, i, graph.limits)) return kForbidden;
    const double cost = pca_energy(i, graph.limits.flat_variance) - x.energy - y.energy;
    return std::isfinite(cost) ? cost : kForbidden;
}

void evaluate_costs(ClusterGraph& graph)
{
    parallel_for(
        graph.edge.size(),
        [&](std::size_t e) {
            ClusterEdge& edge = graph.edge[e];
            if (std::isnan(edge.cost)) edge.cost = merge_cost(graph, edge.a, edge.b);
        },
        kClusterGrain);
}

void join(ClusterGraph& graph, ClusterId a, ClusterId b)
{
    Cluster& cluster = graph.cluster[a];
    cluster.sum += graph.cluster[b].sum;
    cluster.facing += graph.cluster[b].facing;
    cluster.energy = pca_energy(cluster.sum, graph.limits.flat_variance);
    graph.parent[b] = a;
}

void compact(ClusterGraph& graph, const std::vector<std::uint8_t>& changed, EdgeBuffers& buffers)
{
    std::vector<ClusterId> id(graph.cluster.size(), kUnnumbered); // of roots
    std::vector<std::uint8_t> renewed;                            // changed, by new number
    renewed.reserve(graph.count);
    for (const ClusterId root : graph.parent) {
        if (id[root] != kUnnumbered) continue;
        id[root] = static_cast<ClusterId>(renewed.size());
        graph.cluster[id[root]] = graph.cluster[root]; // whose place is free: that cluster has its number already
        renewed.push_back(changed[root]);
    }
    graph.count = renewed.size();
    graph.cluster.resize(graph.count);
    const auto number = [&](ClusterId c) { return id[graph.parent[c]]; };
    for (ClusterId& c : graph.face_cluster)
        c = number(c);
    std::size_t kept = 0;
    for (const ClusterEdge edge : graph.edge) { // without branches, which nobody could predict
        const ClusterId a = number(edge.a), b = number(edge.b);
        graph.edge[kept] = {std::min(a, b), std::max(a, b), (renewed[a] | renewed[b]) != 0 ? kUnknownCost : edge.cost};
        kept += a != b;
    }
    graph.edge.resize(kept);
    drop_doubles(graph.edge, graph.count, buffers);
    graph.parent.resize(graph.count);
    std::iota(graph.parent.begin(), graph.parent.end(), 0u);
}

std::vector<std::uint32_t> cluster_labels(const ClusterGraph& graph)
{
    std::vector<std::uint32_t> label_of_root(graph.parent.size(), kUnnumbered), label(graph.parent.size());
    std::uint32_t count = 0;
    for (ClusterId c = 0; c < label.size(); ++c) {
        ClusterId root = c;
        while (graph.parent[root] != root)
            root = graph.parent[root];
        if (label_of_root[root] == kUnnumbered) label_of_root[root] = count++;
        label[c] = label_of_root[root];
    }
    std::vector<std::uint32_t> face_label(graph.face_cluster.size());
    parallel_for(
        face_label.size(), [&](std::size_t f) { face_label[f] = label[graph.face_cluster[f]]; }, kClusterGrain);
    return face_label;
}

} // namespace quoin
