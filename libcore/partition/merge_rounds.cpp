#include "partition/merge_rounds.h"

#include "base/parallel.h"
#include "base/progress.h"

#include <atomic>

namespace quoin {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr std::uint32_t kNoEdge = 0xffffffffu;
// A round costs a pass over all edges: when it joins less than one cluster in this many, the heap is faster and exact.
constexpr std::size_t kWorthwhile = 50;

// Lowers best[c] to edge e if that is cheaper. The order of edges is total, so the outcome does not depend on who is
// first.
void offer(const ClusterGraph& graph, std::uint32_t& best, std::uint32_t e)
{
    std::atomic_ref<std::uint32_t> slot(best);
    std::uint32_t current = slot.load(std::memory_order_relaxed);
    while (current == kNoEdge || cheaper(graph.edge[e], graph.edge[current]))
        if (slot.compare_exchange_weak(current, e, std::memory_order_relaxed)) return;
}

void find_best_edges(const ClusterGraph& graph, std::vector<std::uint32_t>& best)
{
    best.assign(graph.cluster.size(), kNoEdge);
    parallel_for(
        graph.edge.size(),
        [&](std::size_t e) {
            const ClusterEdge& edge = graph.edge[e];
            if (edge.cost == kForbidden) return;
            offer(graph, best[edge.a], static_cast<std::uint32_t>(e));
            offer(graph, best[edge.b], static_cast<std::uint32_t>(e));
        },
        kGrain);
}

// A cluster is in at most one mutual choice, so that pairs are independent.
std::size_t join_mutual_best(ClusterGraph& graph, const std::vector<std::uint32_t>& best,
                             std::vector<std::uint8_t>& changed)
{
    changed.assign(graph.cluster.size(), 0);
    const auto join_chunk = [&](std::size_t begin, std::size_t end) {
        std::size_t joined = 0;
        for (std::size_t e = begin; e < end; ++e) {
            const ClusterEdge& edge = graph.edge[e];
            if (best[edge.a] != e || best[edge.b] != e) continue;
            join(graph, edge.a, edge.b);
            changed[edge.a] = 1;
            ++joined;
        }
        return joined;
    };
    return parallel_reduce(graph.edge.size(), kGrain, std::size_t{0}, join_chunk, std::plus<>());
}

} // namespace

void merge_in_rounds(ClusterGraph& graph, std::size_t stop_count)
{
    Progress progress("growing clusters in rounds", graph.count - std::min(graph.count, stop_count));
    std::vector<std::uint32_t> best;
    std::vector<std::uint8_t> changed;
    while (graph.count > stop_count) {
        evaluate_costs(graph);
        find_best_edges(graph, best);
        const std::size_t joined = join_mutual_best(graph, best, changed);
        graph.count -= joined;
        rewire(graph, changed);
        progress.step(joined);
        if (joined * kWorthwhile < graph.count) break;
    }
}

} // namespace quoin
