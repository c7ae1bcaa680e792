#include "simplify/curves.h"

#include "mesh/adjacency.h"

#include <algorithm>

namespace quoin {
namespace {

struct BorderEdge {
    std::array<VertexId, 2> end{};
    std::array<PlaneId, 2> planes{kNoPlane, kNoPlane};
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
        if (here != there)
            edges.push_back({{face[h % 3], face[(h % 3 + 1) % 3]}, {std::min(here, there), std::max(here, there)}});
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
        Curve curve{first, 0, first, edges_[edge].planes, false};
        add(start);
        VertexId v = start;
        while (true) {
            used_[edge] = 1;
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

    void add(VertexId v)
    {
        const auto slot = static_cast<std::uint32_t>(curves_.size());
        curves_.vertex.push_back(v);
        curves_.point.push_back(mesh_.mesh.position[v].cast<double>());
        curves_.curve_of.push_back(static_cast<std::uint32_t>(curves_.curve.size()));
        curves_.next.push_back(slot + 1);
        curves_.previous.push_back(slot - 1);
    }

    void close(const Curve& curve)
    {
        const std::uint32_t last = curve.first + curve.count - 1;
        curves_.next[last] = curve.closed ? curve.first : Curves::kNone;
        curves_.previous[curve.first] = curve.closed ? last : Curves::kNone;
        curves_.curve.push_back(curve);
    }

    const PlaneMesh& mesh_;
    std::vector<BorderEdge> edges_;
    EdgesAt at_;
    std::vector<std::uint8_t> used_;
    Curves curves_;
};

} // namespace

Curves trace_curves(const PlaneMesh& mesh) { return Tracer(mesh).trace(); }

} // namespace quoin
