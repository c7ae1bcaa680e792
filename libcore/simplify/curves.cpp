#include "simplify/curves.h"

#include "base/parallel.h"
#include "geometry/radix_sort.h"
#include "mesh/adjacency.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr std::size_t kHalfEdgeGrain = 1 << 16;
constexpr std::size_t kBorderEdgeGrain = 1 << 12;

struct BorderEdge {
    std::array<VertexId, 2> end{};
    std::array<PlaneId, 2> planes{kNoPlane, kNoPlane};
    std::array<int, 2> runs{}; // of the planes' half-edges: 1 from the first end to the second
    VertexId other(VertexId v) const { return end[0] == v ? end[1] : end[0]; }
};

BorderEdge border_edge(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite, std::uint32_t h)
{
    const std::uint32_t o = opposite[h];
    const auto& face = mesh.mesh.face[h / 3];
    const PlaneId here = mesh.face_plane[h / 3], there = o == kBorderEdge ? kNoPlane : mesh.face_plane[o / 3];
    const VertexId from = face[h % 3], to = face[(h % 3 + 1) % 3];
    const int across = o == kBorderEdge ? 0 : mesh.mesh.face[o / 3][o % 3] == from ? 1 : -1;
    if (here < there) return {{from, to}, {here, there}, {1, across}};
    return {{from, to}, {there, here}, {across, 1}};
}

// Border edges at every vertex that has some.
struct EdgesAt {
    std::vector<VertexId> vertex;                    // ascending
    std::vector<std::uint32_t> first, edge;          // by vertex, ascending
    std::vector<std::array<std::uint32_t, 2>> place; // of an edge's ends among the vertices

    explicit EdgesAt(const std::vector<BorderEdge>& edges) : place(edges.size())
    {
        std::vector<Keyed> ends;
        ends.reserve(2 * edges.size());
        for (std::uint32_t e = 0; e < edges.size(); ++e)
            for (const VertexId v : edges[e].end)
                ends.push_back({v, e});
        radix_sort(ends);
        edge.reserve(ends.size());
        for (const auto& [key, e] : ends) {
            const auto v = static_cast<VertexId>(key);
            if (vertex.empty() || vertex.back() != v) {
                vertex.push_back(v);
                first.push_back(static_cast<std::uint32_t>(edge.size()));
            }
            place[e][edges[e].end[0] == v ? 0 : 1] = static_cast<std::uint32_t>(vertex.size() - 1);
            edge.push_back(e);
        }
        first.push_back(static_cast<std::uint32_t>(edge.size()));
    }

    std::span<const std::uint32_t> at(std::size_t i) const { return {edge.data() + first[i], first[i + 1] - first[i]}; }
};

class Tracer {
public:
    Tracer(const PlaneMesh& mesh, std::vector<BorderEdge> edges)
        : mesh_(mesh), edges_(std::move(edges)), at_(edges_), used_(edges_.size(), 0)
    {
    }

    Curves trace()
    {
        for (const VertexClass kind : {VertexClass::Corner, VertexClass::Border})
            for (std::size_t i = 0; i < at_.vertex.size(); ++i)
                if (mesh_.vertex_class[at_.vertex[i]] == kind) trace_from(i);
        return std::move(curves_);
    }

private:
    void trace_from(std::size_t i)
    {
        for (const std::uint32_t edge : at_.at(i))
            if (!used_[edge]) walk(at_.vertex[i], edge);
    }

    void walk(VertexId start, std::uint32_t edge)
    {
        const auto first = static_cast<std::uint32_t>(curves_.size());
        Curve curve{.first = first, .head = first, .planes = edges_[edge].planes};
        add(start);
        VertexId v = start;
        while (true) {
            used_[edge] = 1;
            note_direction(edges_[edge], v, curve, curves_.size() == first + 1);
            v = edges_[edge].other(v);
            if (v == start && mesh_.vertex_class[v] == VertexClass::Border) {
                curve.closed = true;
                break;
            }
            add(v);
            if (mesh_.vertex_class[v] != VertexClass::Border) break;
            const auto edges = at_.at(at_.place[edge][edges_[edge].end[0] == v ? 0 : 1]);
            edge = edges[0] == edge ? edges[1] : edges[0];
        }
        curve.count = static_cast<std::uint32_t>(curves_.size()) - curve.first;
        close(curve);
    }

    static void note_direction(const BorderEdge& edge, VertexId from, Curve& curve, bool is_first)
    {
        for (std::size_t k = 0; k < 2; ++k) {
            const int runs = edge.end[0] == from ? edge.runs[k] : -edge.runs[k];
            if (is_first) curve.runs[k] = runs;
            if (runs != curve.runs[k]) curve.runs[k] = 0;
        }
    }

    void add(VertexId v)
    {
        const auto slot = static_cast<std::uint32_t>(curves_.size());
        curves_.vertex.push_back(v);
        curves_.point.push_back(mesh_.mesh.position[v].cast<double>());
        curves_.curve_of.push_back(static_cast<std::uint32_t>(curves_.curve.size()));
        curves_.next.push_back(slot + 1);
        curves_.previous.push_back(slot - 1); // the ends are mended by restore()
    }

    void close(const Curve& curve)
    {
        curves_.curve.push_back(curve);
        curves_.restore(curves_.curve.back());
    }

    const PlaneMesh& mesh_;
    std::vector<BorderEdge> edges_;
    EdgesAt at_;
    std::vector<std::uint8_t> used_;
    Curves curves_;
};

} // namespace

void Curves::restore(Curve& c)
{
    const std::uint32_t last = c.first + c.count - 1;
    for (std::uint32_t s = c.first; s <= last; ++s) {
        next[s] = s + 1;
        previous[s] = s - 1;
    }
    next[last] = c.closed ? c.first : kNone;
    previous[c.first] = c.closed ? last : kNone;
    c.head = c.first;
}

std::vector<std::uint32_t> border_half_edges(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite)
{
    return parallel_select<std::uint32_t>(opposite.size(), kHalfEdgeGrain, [&](std::size_t h) {
        const std::uint32_t o = opposite[h];
        return o == kBorderEdge || (is_half_edge(o) && h < o && mesh.face_plane[h / 3] != mesh.face_plane[o / 3]);
    });
}

Curves trace_curves(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite,
                    std::span<const std::uint32_t> border)
{
    std::vector<BorderEdge> edges(border.size());
    parallel_for(
        edges.size(), [&](std::size_t e) { edges[e] = border_edge(mesh, opposite, border[e]); }, kBorderEdgeGrain);
    return Tracer(mesh, std::move(edges)).trace();
}

} // namespace quoin
