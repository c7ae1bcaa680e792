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
        : next_(2 * edges.size(), kNone), first_(clusters, kNone), last_(clusters, kNone), size_(clusters, 0),
          gone_(edges.size(), 0)
    {
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            append(edges[e].a, 2 * e);
            append(edges[e].b, 2 * e + 1);
        }
    }
    // At least the number of edges around the cluster.
    std::size_t size(ClusterId c) const { return size_[c]; }
    // What was around b is around a now.
    void splice(ClusterId a, ClusterId b)
    {
        if (first_[b] == kNone) return;
        size_[a] += size_[b];
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
        size_[c] = 0;
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
        ++size_[c];
    }
    std::vector<std::uint32_t> next_, first_, last_, size_;
    std::vector<std::uint8_t> gone_;
};

// Costs of edges are those of the moment, but around clusters with many neighbours, where every join would change all
// of them a little: these are renewed when their turn comes, or when the cluster has grown.
class GreedyMerger {
public:
    explicit GreedyMerger(ClusterGraph& graph)
        : graph_(graph), heap_(graph.edge), lists_(graph.edge, graph.cluster.size()), met_(graph.cluster.size(), 0),
          version_(graph.cluster.size(), 0), evaluated_(graph.edge.size(), 0), renewed_area_(graph.cluster.size(), 0.0)
    {
    }

    bool is_done() const { return heap_.empty(); }

    // Joins the cheapest pair, or finds that its cost is out of date and renews it.
    void step()
    {
        const std::uint32_t e = heap_.top();
        const ClusterEdge& edge = graph_.edge[e];
        if (evaluated_[e] != version_of(edge)) return evaluate(e);
        const bool a_has_more = lists_.size(edge.a) >= lists_.size(edge.b);
        const ClusterId root = a_has_more ? edge.a : edge.b, part = a_has_more ? edge.b : edge.a;
        join(graph_, root, part);
        --graph_.count;
        ++version_[root];
        const bool few = lists_.size(root) + lists_.size(part) <= kFewNeighbours;
        if (few || graph_.cluster[root].sum.area > kGrowth * renewed_area_[root]) {
            lists_.splice(root, part);
            attach(root, root, part);
            renewed_area_[root] = graph_.cluster[root].sum.area;
        } else {
            attach(part, root, part);
            lists_.splice(root, part);
        }
    }

private:
    static constexpr std::size_t kFewNeighbours = 64;
    static constexpr double kGrowth = 1.1;

    std::uint32_t version_of(const ClusterEdge& edge) const { return version_[edge.a] + version_[edge.b]; }

    void evaluate(std::uint32_t e)
    {
        ClusterEdge& edge = graph_.edge[e];
        edge.cost = merge_cost(graph_, edge.a, edge.b);
        evaluated_[e] = version_of(edge);
        heap_.update(e);
    }

    // The edges in the list of a cluster become those of `root`, which `part` was joined to. Drops the edges between
    // the two, and doubles.
    void attach(ClusterId list, ClusterId root, ClusterId part)
    {
        ++walk_;
        lists_.filter(list, [&](std::uint32_t end) {
            ClusterEdge& edge = graph_.edge[end / 2];
            const ClusterId other = end % 2 == 0 ? edge.b : edge.a;
            (end % 2 == 0 ? edge.a : edge.b) = root;
            if (other == root || other == part || met_[other] == walk_) {
                heap_.remove(end / 2);
                return false;
            }
            met_[other] = walk_;
            evaluate(end / 2);
            return true;
        });
    }

    ClusterGraph& graph_;
    EdgeHeap heap_;
    EdgeLists lists_;
    std::vector<std::uint32_t> met_; // the walk that met this cluster last
    std::uint32_t walk_ = 0;
    std::vector<std::uint32_t> version_;   // of clusters: joins so far
    std::vector<std::uint32_t> evaluated_; // of edges: versions of both ends when the cost was found
    std::vector<double> renewed_area_;     // of clusters when all costs around them were found [m^2]
};

} // namespace

void merge_by_heap(ClusterGraph& graph, std::size_t target)
{
    constexpr std::size_t kReportEvery = 4096;
    evaluate_costs(graph);
    Progress progress("growing clusters exactly", graph.count - std::min(graph.count, target));
    GreedyMerger merger(graph);
    for (std::size_t reported = graph.count; graph.count > target && !merger.is_done();) {
        merger.step();
        if (reported - graph.count < kReportEvery) continue;
        progress.step(reported - graph.count);
        reported = graph.count;
    }
    graph.edge.clear();
}

} // namespace quoin
