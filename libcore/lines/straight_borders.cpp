#include "lines/straight_borders.h"

#include "mesh/adjacency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>

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
        if (opposite[h] == kBorderEdge || opposite[h] == kNonManifoldEdge || opposite[h] < h) continue;
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
                ends_.push_back({v, e});
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

struct FittedLine {
    Eigen::Vector3d point, direction;
    double rms;           // [m]
    std::size_t farthest; // point of the polyline
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
    FittedLine line{mean, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(2).normalized(),
                    0.0, 0};
    double squares = 0.0, largest = -1.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d d = points[i] - mean;
        const double distance2 = (d - d.dot(line.direction) * line.direction).squaredNorm();
        squares += distance2;
        if (distance2 > largest) std::tie(largest, line.farthest) = std::pair(distance2, i);
    }
    line.rms = std::sqrt(squares / static_cast<double>(points.size()));
    return line;
}

// Appends the straight pieces of a polyline: the whole, or those of the two parts it has at the point that is farthest
// from its line, or from its chord where that is an end.
void cut(std::span<const Eigen::Vector3d> points, const Planes& planes, const BorderLimits& limits,
         std::vector<StraightBorder>& out)
{
    std::vector<std::span<const Eigen::Vector3d>> open{points};
    while (!open.empty()) {
        const auto piece = open.back();
        open.pop_back();
        if (piece.size() < 2) continue;
        const FittedLine line = fit_line(piece);
        if (line.rms > limits.max_rms) {
            const std::size_t middle = std::clamp<std::size_t>(line.farthest, 1, piece.size() - 2);
            open.push_back(piece.subspan(middle));
            open.push_back(piece.first(middle + 1));
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
        for (const auto& line : Chainer(mesh.mesh, std::span(edges).subspan(begin, end - begin)).chains())
            cut(line, edges[begin].planes, limits, borders);
        begin = end;
    }
    return borders;
}

} // namespace quoin
