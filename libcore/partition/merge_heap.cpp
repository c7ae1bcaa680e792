#include "partition/merge_heap.h"

#include "base/progress.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// A heap of edges that knows where each edge is, so that costs change in place and no entry is ever stale. Entries have
// their costs with them, and four children lie side by side: a comparison seldom looks elsewhere in memory.
class EdgeHeap {
public:
    explicit EdgeHeap(const std::vector<ClusterEdge>& edges) : edges_(edges), place_(edges.size(), kNone)
    {
        heap_.reserve(edges.size());
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            if (edges[e].cost == kForbidden) continue;
            place_[e] = static_cast<std::uint32_t>(heap_.size());
            heap_.push_back({edges[e].cost, e});
        }
        for (std::size_t i = heap_.size() / kChildren + 1; i-- > 0;)
            if (i < heap_.size()) sift_down(i);
    }
    bool empty() const { return heap_.empty(); }
    std::uint32_t top() const { return heap_.front().edge; }

    void remove(std::uint32_t e)
    {
        const std::uint32_t hole = place_[e];
        if (hole == kNone) return;
        place_[e] = kNone;
        const Entry last = heap_.back();
        heap_.pop_back();
        if (last.edge == e) return;
        put(hole, last);
        settle(hole);
    }

    // Call after the cost of an edge changed.
    void update(std::uint32_t e)
    {
        if (edges_[e].cost == kForbidden) return remove(e);
        if (place_[e] == kNone) {
            place_[e] = static_cast<std::uint32_t>(heap_.size());
            heap_.push_back({});
        }
        heap_[place_[e]] = {edges_[e].cost, e};
        settle(place_[e]);
    }

private:
    static constexpr std::size_t kChildren = 4;
    struct Entry {
        double cost = 0.0;
        std::uint32_t edge = 0;
    };

    bool before(const Entry& x, const Entry& y) const
    {
        return x.cost != y.cost ? x.cost < y.cost : cheaper(edges_[x.edge], edges_[y.edge]);
    }
    void put(std::size_t i, const Entry& entry)
    {
        heap_[i] = entry;
        place_[entry.edge] = static_cast<std::uint32_t>(i);
    }
    void settle(std::size_t i) { sift_down(sift_up(i)); }
    std::size_t sift_up(std::size_t i)
    {
        const Entry entry = heap_[i];
        for (; i > 0 && before(entry, heap_[(i - 1) / kChildren]); i = (i - 1) / kChildren)
            put(i, heap_[(i - 1) / kChildren]);
        put(i, entry);
        return i;
    }
    void sift_down(std::size_t i)
    {
        const Entry entry = heap_[i];
        for (std::size_t first = kChildren * i + 1; first < heap_.size(); first = kChildren * i + 1) {
            std::size_t child = first;
            for (std::size_t c = first + 1; c < std::min(first + kChildren, heap_.size()); ++c)
                if (before(heap_[c], heap_[child])) child = c;
            if (!before(heap_[child], entry)) break;
            put(i, heap_[child]);
            i = child;
        }
        put(i, entry);
    }

    const std::vector<ClusterEdge>& edges_;
    std::vector<Entry> heap_;
    std::vector<std::uint32_t> place_; // per edge; kNone = not in the heap
};

// The edges around every cluster as singly linked lists of edge ends (end 2e is edge[e].a's, 2e+1 is edge[e].b's),
// which are joined in constant time. Edges that are gone stay linked at their other end until that list is walked.
class EdgeLists {
public:
    EdgeLists(const std::vector<ClusterEdge>& edges, std::size_t clusters)
        : next_(2 * edges.size(), kNone), first_(clusters, kNone), last_(clusters, kNone), gone_(edges.size(), 0)
    {
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            append(edges[e].a, 2 * e);
            append(edges[e].b, 2 * e + 1);
        }
    }
    void splice(ClusterId a, ClusterId b)
    {
        if (first_[b] == kNone) return;
        if (first_[a] == kNone)
            first_[a] = first_[b];
        else
            next_[last_[a]] = first_[b];
        last_[a] = last_[b];
    }
    // Walks the list of a cluster; ends for which keep(end) is false leave it, and their edge is gone.
    template <class Keep>
    void filter(ClusterId c, const Keep& keep)
    {
        std::uint32_t end = first_[c];
        first_[c] = last_[c] = kNone;
        while (end != kNone) {
            const std::uint32_t following = next_[end];
            next_[end] = kNone;
            if (!gone_[end / 2]) {
                if (keep(end))
                    append(c, end);
                else
                    gone_[end / 2] = 1;
            }
            end = following;
        }
    }

private:
    void append(ClusterId c, std::uint32_t end)
    {
        if (first_[c] == kNone)
            first_[c] = end;
        else
            next_[last_[c]] = end;
        last_[c] = end;
    }
    std::vector<std::uint32_t> next_, first_, last_;
    std::vector<std::uint8_t> gone_;
};

} // namespace

void merge_by_heap(ClusterGraph& graph, std::size_t target)
{
    constexpr std::size_t kReportEvery = 4096;
    evaluate_costs(graph);
    EdgeHeap heap(graph.edge);
    EdgeLists lists(graph.edge, graph.cluster.size());
    std::vector<std::uint32_t> met(graph.cluster.size(), 0); // the walk that met this cluster last
    std::uint32_t walk = 0;
    Progress progress("growing clusters exactly", graph.count - std::min(graph.count, target));
    while (graph.count > target && !heap.empty()) {
        const auto [a, b, cost] = graph.edge[heap.top()];
        join(graph, a, b);
        --graph.count;
        lists.splice(a, b);
        ++walk;
        const auto attach = [&, a = a, b = b](std::uint32_t end) { // false for the edge a-b and for doubles
            ClusterEdge& edge = graph.edge[end / 2];
            const ClusterId other = end % 2 == 0 ? edge.b : edge.a;
            (end % 2 == 0 ? edge.a : edge.b) = a;
            if (other == a || other == b || met[other] == walk) {
                heap.remove(end / 2);
                return false;
            }
            met[other] = walk;
            edge.cost = merge_cost(graph, a, other);
            heap.update(end / 2);
            return true;
        };
        lists.filter(a, attach);
        if (graph.count % kReportEvery == 0) progress.step(kReportEvery);
    }
    graph.edge.clear();
}

} // namespace quoin
