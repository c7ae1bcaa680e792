#include "partition/merge_rounds.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr std::uint32_t kNoEdge = 0xffffffffu;
// A round costs a pass over all edges: when it joins less than one cluster in this many, the heap is faster and exact.
constexpr std::size_t kWorthwhile = 100;
// Clusters of fewer faces all join their choice; of larger ones only the cheaper half of the pairs joins in a round, so
// that the order of joins comes near the greedy one.
constexpr std::size_t kFewFaces = 4;

void find_best_edges(const ClusterGraph& graph, std::vector<std::uint32_t>& best)
{
    best.assign(graph.cluster.size(), kNoEdge);
    for (std::uint32_t e = 0; e < graph.edge.size(); ++e) {
        const ClusterEdge& edge = graph.edge[e];
        if (edge.cost == kForbidden) continue;
        for (const ClusterId end : {edge.a, edge.b})
            if (best[end] == kNoEdge || cheaper(edge, graph.edge[best[end]])) best[end] = e;
    }
}

// Edges that both ends would choose. A cluster is in at most one of them, so that they are independent.
std::vector<std::uint32_t> mutual_choices(const ClusterGraph& graph, const std::vector<std::uint32_t>& best)
{
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t e = 0; e < graph.edge.size(); ++e)
        if (best[graph.edge[e].a] == e && best[graph.edge[e].b] == e) chosen.push_back(e);
    return chosen;
}

void keep_cheaper_half(const ClusterGraph& graph, std::vector<std::uint32_t>& edges)
{
    const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
    if (middle == edges.end()) return;
    std::nth_element(edges.begin(), middle, edges.end(),
                     [&](std::uint32_t x, std::uint32_t y) { return cheaper(graph.edge[x], graph.edge[y]); });
    edges.erase(middle + 1, edges.end());
}

} // namespace

void merge_in_rounds(ClusterGraph& graph, std::size_t stop_count)
{
    const std::size_t few = graph.face_cluster.size() / kFewFaces;
    std::vector<std::uint32_t> best;
    std::vector<std::uint8_t> changed;
    while (graph.count > stop_count) {
        evaluate_costs(graph);
        find_best_edges(graph, best);
        std::vector<std::uint32_t> chosen = mutual_choices(graph, best);
        if (graph.count <= few) keep_cheaper_half(graph, chosen);
        changed.assign(graph.cluster.size(), 0);
        for (const std::uint32_t e : chosen) {
            join(graph, graph.edge[e].a, graph.edge[e].b);
            changed[graph.edge[e].a] = 1;
        }
        compact(graph, changed);
        if (chosen.size() * kWorthwhile < graph.count) break;
    }
}

} // namespace quoin
