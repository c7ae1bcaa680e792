#include "lines/straight_borders.h"

#include "mesh/adjacency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace quoin {
namespace {

using Planes = std::array<PlaneId, 2>;
using Polyline = std::vector<Eigen::Vector3d>;

struct BorderEdge {
    Planes planes;
    std::array<VertexId, 2> vertices;
};

std::vector<BorderEdge> sharp_edges(const PlaneMesh& mesh, double min_angle)
{
    const double max_cosine = std::cos(min_angle);
    const auto opposite = opposite_half_edges(mesh.mesh);
    std::vector<BorderEdge> edges;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        if (!is_half_edge(opposite[h]) || opposite[h] < h) continue;
        const auto [a, b] = std::minmax(mesh.face_plane[h / 3], mesh.face_plane[opposite[h] / 3]);
        if (a == b || std::abs(mesh.plane[a].normal.dot(mesh.plane[b].normal)) > max_cosine) continue;
        const auto& face = mesh.mesh.face[h / 3];
        edges.push_back({{a, b}, {face[h % 3], face[(h % 3 + 1) % 3]}});
    }
    std::stable_sort(edges.begin(), edges.end(), [](const auto& x, const auto& y) { return x.planes < y.planes; });
    return edges;
}

// Walks the edges of one pair of planes from end to end, then around what is left, the closed ones.
class Chainer {
public:
    Chainer(const TriangleMesh& mesh, std::span<const BorderEdge> edges)
        : mesh_(mesh), edges_(edges), used_(edges.size(), 0)
    {
        for (std::uint32_t e = 0; e < edges.size(); ++e)
            for (const VertexId v : edges[e].vertices)
                ends_.emplace_back(v, e);
        std::sort(ends_.begin(), ends_.end());
    }

    std::vector<Polyline> chains()
    {
        std::vector<Polyline> result;
        for (const bool from_ends : {true, false})
            for (const auto& [v, e] : ends_)
                if (!used_[e] && (!from_ends || edges_at(v).size() != 2)) result.push_back(walk(v, e));
        return result;
    }

private:
    using End = std::pair<VertexId, std::uint32_t>; // vertex, edge

    std::span<const End> edges_at(VertexId v) const
    {
        const auto [first, last] = std::equal_range(ends_.begin(), ends_.end(), End{v, 0},
                                                    [](const End& x, const End& y) { return x.first < y.first; });
        return {first, last};
    }

    Polyline walk(VertexId v, std::uint32_t e)
    {
        Polyline line{mesh_.position[v].cast<double>()};
        for (;;) {
            used_[e] = 1;
            v = edges_[e].vertices[0] == v ? edges_[e].vertices[1] : edges_[e].vertices[0];
            line.push_back(mesh_.position[v].cast<double>());
            const auto around = edges_at(v);
            const auto next = std::ranges::find_if(around, [&](const End& end) { return !used_[end.second]; });
            if (around.size() != 2 || next == around.end()) return line;
            e = next->second;
        }
    }

    const TriangleMesh& mesh_;
    std::span<const BorderEdge> edges_;
    std::vector<End> ends_;
    std::vector<std::uint8_t> used_;
};

// Appends the nearest of the chains left, if one ends within `gap` of the line's end, again and again.
void extend(Polyline& line, std::vector<Polyline>& chains, double gap)
{
    for (;;) {
        Polyline* nearest = nullptr;
        double least = gap;
        for (auto& chain : chains) {
            if (chain.empty()) continue;
            const double to_front = (chain.front() - line.back()).norm(), to_back = (chain.back() - line.back()).norm();
            if (std::min(to_front, to_back) > least || (nearest && std::min(to_front, to_back) == least)) continue;
            if (to_back < to_front) std::reverse(chain.begin(), chain.end());
            least = std::min(to_front, to_back);
            nearest = &chain;
        }
        if (!nearest) return;
        line.insert(line.end(), nearest->begin(), nearest->end());
        nearest->clear();
    }
}

// Chains that follow each other become one: slivers and faces that touch in a vertex interrupt the borders of real
// scans.
std::vector<Polyline> link(std::vector<Polyline> chains, double gap)
{
    std::vector<Polyline> lines;
    for (auto& chain : chains) {
        if (chain.empty()) continue;
        Polyline line = std::exchange(chain, {});
        const bool closed = line.front() == line.back();
        for (int side = 0; side < 2 && !closed; ++side) {
            extend(line, chains, gap);
            std::reverse(line.begin(), line.end());
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

struct FittedLine {
    Eigen::Vector3d point, direction;
    double rms; // [m]
};

FittedLine fit_line(std::span<const Eigen::Vector3d> points)
{
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : points)
        mean += p;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : points)
        scatter += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
    const double across = std::max(0.0, axes.eigenvalues()[0]) + std::max(0.0, axes.eigenvalues()[1]);
    return {mean, axes.eigenvectors().col(2).normalized(), std::sqrt(across / static_cast<double>(points.size()))};
}

// The inner point that is farthest from the chord between the ends; from the first point where the ends are one.
std::size_t farthest_from_chord(std::span<const Eigen::Vector3d> points)
{
    const Eigen::Vector3d chord = points.back() - points.front();
    const Eigen::Vector3d along = chord.norm() > 0.0 ? Eigen::Vector3d(chord.normalized()) : Eigen::Vector3d::Zero();
    std::size_t farthest = points.size() / 2;
    double largest = 0.0;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const Eigen::Vector3d d = points[i] - points.front();
        const double distance2 = (d - d.dot(along) * along).squaredNorm();
        if (distance2 > largest) {
            largest = distance2;
            farthest = i;
        }
    }
    return farthest;
}

// Appends the straight pieces of a polyline: the whole, or those of the two parts it has at its sharpest bend.
void cut(std::span<const Eigen::Vector3d> points, const Planes& planes, const BorderLimits& limits,
         std::vector<StraightBorder>& out)
{
    std::vector<std::span<const Eigen::Vector3d>> open{points};
    while (!open.empty()) {
        const auto piece = open.back();
        open.pop_back();
        const FittedLine line = fit_line(piece);
        if (line.rms > limits.max_rms && piece.size() > 2) {
            const std::size_t bend = farthest_from_chord(piece);
            open.push_back(piece.subspan(bend));
            open.push_back(piece.first(bend + 1));
            continue;
        }
        double low = 0.0, high = 0.0;
        for (const auto& p : piece) {
            const double t = (p - line.point).dot(line.direction);
            low = std::min(low, t);
            high = std::max(high, t);
        }
        if (high - low >= limits.min_length)
            out.push_back({planes, {line.point + low * line.direction, line.point + high * line.direction}});
    }
}

} // namespace

std::vector<StraightBorder> straight_borders(const PlaneMesh& mesh, const BorderLimits& limits)
{
    const auto edges = sharp_edges(mesh, limits.min_angle);
    std::vector<StraightBorder> borders;
    for (std::size_t begin = 0; begin < edges.size();) {
        std::size_t end = begin;
        while (end < edges.size() && edges[end].planes == edges[begin].planes)
            ++end;
        const auto chains = Chainer(mesh.mesh, std::span(edges).subspan(begin, end - begin)).chains();
        for (const auto& line : link(chains, limits.max_gap))
            cut(line, edges[begin].planes, limits, borders);
        begin = end;
    }
    return borders;
}

} // namespace quoin
