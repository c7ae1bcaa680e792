#include "partition/grow_regions.h"

#include "base/progress.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace quoin {
namespace {

// The plane of a region is fitted anew when its area has grown by this factor since the last fit.
constexpr double kRefitGrowth = 1.2;

struct Region {
    ClusterId root;
    Plane plane;
    double fitted_area;
};

// Faces by the angle to their most different neighbour, flattest first.
std::vector<FaceId> rank_seeds(const ClusterGraph& graph, const std::vector<std::uint32_t>& opposite)
{
    std::vector<float> bend(graph.cluster.size(), 2.0f);
    for (FaceId f = 0; f < bend.size(); ++f) {
        const Eigen::Vector3f normal = graph.cluster[f].facing.normalized();
        float worst = 0.0f;
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
            if (is_half_edge(opposite[h]))
                worst = std::max(worst, 1.0f - normal.dot(graph.cluster[opposite[h] / 3].facing.normalized()));
        if (normal.allFinite() && normal.squaredNorm() > 0.0f) bend[f] = worst;
    }
    std::vector<FaceId> order(bend.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](FaceId a, FaceId b) { return bend[a] < bend[b]; });
    return order;
}

Plane oriented_plane(const Cluster& cluster)
{
    const Plane plane = fit_plane(cluster.sum);
    return plane.normal.dot(cluster.facing.cast<double>()) < 0.0 ? plane.flipped() : plane;
}

bool fits(const ClusterGraph& graph, const Region& region, FaceId f, const RegionLimits& limits)
{
    const Cluster &cluster = graph.cluster[region.root], &face = graph.cluster[f];
    const double cosine = region.plane.normal.dot(face.facing.cast<double>()) / face.facing.norm();
    return cosine >= limits.min_cosine && rms_to_plane(face.sum, region.plane) <= limits.max_distance &&
           may_join(cluster, face, graph.limits);
}

void grow_from(ClusterGraph& graph, FaceId seed, const std::vector<std::uint32_t>& opposite, const RegionLimits& limits,
               std::vector<std::uint8_t>& taken)
{
    Region region{seed, oriented_plane(graph.cluster[seed]), graph.cluster[seed].sum.area};
    std::vector<FaceId> queue{seed};
    taken[seed] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        for (std::uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
            const FaceId f = opposite[h] / 3;
            if (!is_half_edge(opposite[h]) || taken[f] || !fits(graph, region, f, limits)) continue;
            join(graph, seed, f);
            taken[f] = 1;
            queue.push_back(f);
        }
        const Cluster& cluster = graph.cluster[seed];
        if (cluster.sum.area < kRefitGrowth * region.fitted_area) continue;
        region.plane = oriented_plane(cluster);
        region.fitted_area = cluster.sum.area;
    }
}

} // namespace

void grow_regions(ClusterGraph& graph, const std::vector<std::uint32_t>& opposite, const RegionLimits& limits)
{
    Progress progress("growing regions", graph.count);
    std::vector<std::uint8_t> taken(graph.cluster.size(), 0);
    for (const FaceId seed : rank_seeds(graph, opposite))
        if (!taken[seed]) grow_from(graph, seed, opposite, limits, taken);
    progress.step(graph.cluster.size());
    EdgeBuffers buffers;
    compact(graph, std::vector<std::uint8_t>(graph.cluster.size(), 1), buffers);
}

} // namespace quoin
