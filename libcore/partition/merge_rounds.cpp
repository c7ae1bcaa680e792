#include "partition/merge_rounds.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

constexpr std::uint32_t kNoEdge = 0xffffffffu;
// A round costs a pass over all edges: when it joins less than one cluster in this many, the heap is faster and exact.
constexpr std::size_t kWorthwhile = 100;
// Clusters of fewer faces all join their choice; of larger ones only the cheaper half of the pairs joins in a round, so
// that the order of joins comes near the greedy one.
constexpr std::size_t kFewFaces = 4;

struct Choice {
    double cost = kForbidden;
    std::uint32_t edge = kNoEdge;
};

// Without branches but for ties: nobody could predict them.
Choice better(const Choice& best, const ClusterGraph& graph, std::uint32_t e)
{
    const double cost = graph.edge[e].cost;
    bool cheaper_one = cost < best.cost;
    if (cost == best.cost && best.edge != kNoEdge) cheaper_one = cheaper(graph.edge[e], graph.edge[best.edge]);
    return {cheaper_one ? cost : best.cost, cheaper_one ? e : best.edge};
}

// The cheapest edge of every cluster; finds the costs that are unknown. Edges are in the order of their first ends.
void find_choices(ClusterGraph& graph, std::vector<Choice>& choice)
{
    choice.assign(graph.cluster.size(), {});
    for (std::uint32_t e = 0; e < graph.edge.size();) {
        const ClusterId a = graph.edge[e].a;
        Choice best = choice[a];
        for (; e < graph.edge.size() && graph.edge[e].a == a; ++e) {
            ClusterEdge& edge = graph.edge[e];
            if (std::isnan(edge.cost)) edge.cost = merge_cost(graph, a, edge.b);
            best = better(best, graph, e);
            choice[edge.b] = better(choice[edge.b], graph, e);
        }
        choice[a] = best;
    }
}

// Edges that both ends would choose. A cluster is in at most one of them, so that they are independent.
std::vector<std::uint32_t> mutual_choices(const ClusterGraph& graph, const std::vector<Choice>& choice)
{
    std::vector<std::uint32_t> chosen;
    for (ClusterId c = 0; c < choice.size(); ++c) {
        const std::uint32_t e = choice[c].edge;
        if (e != kNoEdge && graph.edge[e].a == c && choice[graph.edge[e].b].edge == e) chosen.push_back(e);
    }
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
    std::vector<Choice> choice;
    EdgeBuffers buffers;
    std::vector<std::uint8_t> changed;
    while (graph.count > stop_count) {
        find_choices(graph, choice);
        std::vector<std::uint32_t> chosen = mutual_choices(graph, choice);
        if (graph.count <= few) keep_cheaper_half(graph, chosen);
        changed.assign(graph.cluster.size(), 0);
        for (const std::uint32_t e : chosen) {
            join(graph, graph.edge[e].a, graph.edge[e].b);
            changed[graph.edge[e].a] = 1;
        }
        compact(graph, changed, buffers);
        if (chosen.size() * kWorthwhile < graph.count) break;
    }
}

} // namespace quoin
