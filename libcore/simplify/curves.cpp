#include "simplify/curves.h"

#include "mesh/adjacency.h"

#include <algorithm>

namespace quoin {
namespace {

struct BorderEdge {
    std::array<VertexId, 2> end{};
    std::array<PlaneId, 2> planes{kNoPlane, kNoPlane};
    std::array<int, 2> runs{}; // of the planes' half-edges: 1 from the first end to the second
    VertexId other(VertexId v) const { return end[0] == v ? end[1] : end[0]; }
};

std::vector<BorderEdge> border_edges(const PlaneMesh& mesh)
{
    const auto opposite = opposite_half_edges(mesh.mesh);
    std::vector<BorderEdge> edges;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        const std::uint32_t o = opposite[h];
        if (o == kNonManifoldEdge || (o != kBorderEdge && o < h)) continue;
        const auto& face = mesh.mesh.face[h / 3];
        const PlaneId here = mesh.face_plane[h / 3], there = o == kBorderEdge ? kNoPlane : mesh.face_plane[o / 3];
        if (here == there) continue;
        const VertexId from = face[h % 3], to = face[(h % 3 + 1) % 3];
        const int across = o == kBorderEdge ? 0 : mesh.mesh.face[o / 3][o % 3] == from ? 1 : -1;
        if (here < there)
            edges.push_back({{from, to}, {here, there}, {1, across}});
        else
            edges.push_back({{from, to}, {there, here}, {across, 1}});
    }
    return edges;
}

// Border edges at every vertex.
struct EdgesAt {
    std::vector<std::uint32_t> first, edge;

    EdgesAt(const std::vector<BorderEdge>& edges, std::size_t vertices) : first(vertices + 1, 0), edge(2 * edges.size())
    {
        for (const auto& e : edges)
            for (const VertexId v : e.end)
                ++first[v + 1];
        for (std::size_t v = 0; v < vertices; ++v)
            first[v + 1] += first[v];
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        for (std::uint32_t e = 0; e < edges.size(); ++e)
            for (const VertexId v : edges[e].end)
                edge[next[v]++] = e;
    }
};

class Tracer {
public:
    explicit Tracer(const PlaneMesh& mesh)
        : mesh_(mesh), edges_(border_edges(mesh)), at_(edges_, mesh.mesh.position.size()), used_(edges_.size(), 0)
    {
    }

    Curves trace()
    {
        const auto vertices = static_cast<VertexId>(mesh_.mesh.position.size());
        for (VertexId v = 0; v < vertices; ++v)
            if (mesh_.vertex_class[v] == VertexClass::Corner) trace_from(v);
        for (VertexId v = 0; v < vertices; ++v)
            if (mesh_.vertex_class[v] == VertexClass::Border) trace_from(v);
        return std::move(curves_);
    }

private:
    void trace_from(VertexId start)
    {
        for (std::uint32_t i = at_.first[start]; i < at_.first[start + 1]; ++i)
            if (!used_[at_.edge[i]]) walk(start, at_.edge[i]);
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
            const std::uint32_t one = at_.edge[at_.first[v]], two = at_.edge[at_.first[v] + 1];
            edge = one == edge ? two : one;
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

Curves trace_curves(const PlaneMesh& mesh) { return Tracer(mesh).trace(); }

} // namespace quoin
