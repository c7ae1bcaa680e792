// Clusters of faces and which of them are neighbours: the state that every way to grow clusters works on.
#pragma once

#include "geometry/moments.h"
#include "mesh/triangle_mesh.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace quoin {

using ClusterId = std::uint32_t;

struct Cluster {
    Moments sum;                                      // about ClusterGraph::origin
    double energy = 0.0;                              // of `sum` [m^4]
    Eigen::Vector3f facing = Eigen::Vector3f::Zero(); // sum of the faces' areas along their normals [m^2]
};

struct ClusterEdge {
    ClusterId a = 0, b = 0; // a < b
    double cost = 0.0;      // of joining them [m^4]; kUnknownCost until asked for
};
inline constexpr double kUnknownCost = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kForbidden = std::numeric_limits<double>::infinity();

struct MergeLimits {
    double max_error = kForbidden; // largest RMS distance of a union to its plane [m]
    double min_facing = 0.0;       // least |facing| / area of a union
    double min_part_cosine = -1.0; // least cosine between the facing of either part and that of their union
    double flat_variance = 0.0;    // [m^2], see pca_energy
};

// Clusters are numbered in the order of their first face.
struct ClusterGraph {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(); // near the mesh, so that moments keep their digits
    MergeLimits limits;
    std::vector<Cluster> cluster;        // C; roots count
    std::vector<ClusterId> parent;       // C; leads to the root
    std::vector<ClusterEdge> edge;       // neighbouring roots, each pair once, in the order of their first ends
    std::vector<ClusterId> face_cluster; // F; a cluster that is or became a part of the face's cluster
    std::size_t count = 0;               // clusters left
};

// Every face a cluster of its own. opposite: opposite_half_edges(mesh).
ClusterGraph clusters_of_faces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                               const MergeLimits& limits);

// Larger clusters: grow(block) joins those of a block of consecutive faces, which fits in a processor's cache, among
// themselves. Blocks are grown in parallel and then put together.
ClusterGraph clusters_of_blocks(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                const MergeLimits& limits, const std::function<void(ClusterGraph& block)>& grow);

// E(a + b) - E(a) - E(b) [m^4], or kForbidden where the union breaks a limit.
double merge_cost(const ClusterGraph& graph, ClusterId a, ClusterId b);

// Gives every edge whose cost is unknown its merge_cost.
void evaluate_costs(ClusterGraph& graph);

// May they be one plane? Each part is asked too, not only their union: in the sums of a wall a mug that hangs on it, or
// the few faces of a fold, vanish.
bool may_join(const Cluster& a, const Cluster& b, const MergeLimits& limits);

// b becomes a part of a; edges stay as they are.
void join(ClusterGraph& graph, ClusterId a, ClusterId b);

struct EdgeBuffers { // used again by every call, for memory that is touched first costs more than what is done with it
    std::vector<std::uint32_t> next, met;
    std::vector<ClusterEdge> sorted;
};

// Keeps the roots alone, numbered anew, and the edges between them. Costs of edges with an end that is changed[root]
// are kUnknownCost. Every parent must be a root.
void compact(ClusterGraph& graph, const std::vector<std::uint8_t>& changed, EdgeBuffers& buffers);

// Breaks ties of equal cost. A hash, for on flat walls all costs are equal, and by index every cluster would choose the
// same neighbour as the one before it: mutual choices become rare and the rounds never end.
inline std::uint64_t pair_hash(ClusterId a, ClusterId b)
{
    std::uint64_t x = (std::uint64_t{a} << 32) | b; // splitmix64, one-to-one: the order of pairs is total
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
inline bool cheaper(const ClusterEdge& x, const ClusterEdge& y)
{
    return x.cost != y.cost ? x.cost < y.cost : pair_hash(x.a, x.b) < pair_hash(y.a, y.b);
}

// The cluster of every face, numbered in the order of the first faces.
std::vector<std::uint32_t> cluster_labels(const ClusterGraph& graph);

} // namespace quoin
