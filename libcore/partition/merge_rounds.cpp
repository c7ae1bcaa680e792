#include "partition/merge_rounds.h"

namespace quoin {
namespace {

constexpr std::uint32_t kNoEdge = 0xffffffffu;
// A round costs a pass over all edges: when it joins less than one cluster in this many, the heap is faster and exact.
constexpr std::size_t kWorthwhile = 50;

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

// A cluster is in at most one mutual choice, so that pairs are independent. Returns their number.
std::size_t join_mutual_best(ClusterGraph& graph, const std::vector<std::uint32_t>& best,
                             std::vector<std::uint8_t>& changed)
{
    changed.assign(graph.cluster.size(), 0);
    std::size_t joined = 0;
    for (std::uint32_t e = 0; e < graph.edge.size(); ++e) {
        const ClusterEdge& edge = graph.edge[e];
        if (best[edge.a] != e || best[edge.b] != e) continue;
        join(graph, edge.a, edge.b);
        changed[edge.a] = 1;
        ++joined;
    }
    return joined;
}

} // namespace

void merge_in_rounds(ClusterGraph& graph, std::size_t stop_count)
{
    std::vector<std::uint32_t> best;
    std::vector<std::uint8_t> changed;
    while (graph.count > stop_count) {
        evaluate_costs(graph);
        find_best_edges(graph, best);
        const std::size_t joined = join_mutual_best(graph, best, changed);
        compact(graph, changed);
        if (joined * kWorthwhile < graph.count) break;
    }
}

} // namespace quoin
