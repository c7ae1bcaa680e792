#include "merge/neighbour_graph.h"

#include "geometry/pca_energy.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace quoin {
namespace {

constexpr double kRounding = 1e-7; // of single precision coordinates, relative to the size of the mesh

// Borders along edges of three or more faces: every two planes that meet there are neighbours.
struct FanEdge {
    std::pair<VertexId, VertexId> vertices;
    PlaneId plane;
    auto operator<=>(const FanEdge&) const = default;
};

std::vector<FanEdge> fans_of(const BorderStrip& strip)
{
    std::vector<FanEdge> fans;
    for (std::uint32_t h = 0; h < strip.opposite.size(); ++h) {
        if (strip.opposite[h] != kNonManifoldEdge) continue;
        const auto& face = strip.mesh.face[h / 3];
        fans.push_back({std::minmax({face[h % 3], face[(h % 3 + 1) % 3]}), strip.face_plane[h / 3]});
    }
    std::sort(fans.begin(), fans.end());
    fans.erase(std::unique(fans.begin(), fans.end()), fans.end());
    return fans;
}

double length_of(const TriangleMesh& mesh, VertexId a, VertexId b)
{
    return (mesh.position[a] - mesh.position[b]).cast<double>().norm();
}

} // namespace

NeighbourGraph::NeighbourGraph(const PlaneMesh& mesh, const BorderStrip& strip)
    : clusters_(mesh.plane.size()), borders_(mesh.plane.size()), parent_(mesh.plane.size())
{
    Eigen::AlignedBox3d box;
    for (const auto& moments : mesh.moments)
        box.extend(moments.centroid());
    const Eigen::Vector3d origin = box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.center());
    const double rounding = kRounding * (box.isEmpty() ? 0.0 : box.diagonal().norm() + std::sqrt(mesh.moments[0].area));
    flat_variance_ = rounding * rounding;
    for (PlaneId p = 0; p < size(); ++p) {
        parent_[p] = p;
        clusters_[p].sum = mesh.moments[p].translated(-origin);
        clusters_[p].facing = mesh.moments[p].area * mesh.plane[p].normal;
        refresh(clusters_[p]);
    }
    add_borders(strip);
}

void NeighbourGraph::add_borders(const BorderStrip& strip)
{
    const auto add = [&](PlaneId a, PlaneId b, double length) {
        if (a == b) return;
        borders_[a][b] += length;
        borders_[b][a] += length;
    };
    const auto& opposite = strip.opposite;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        const auto& face = strip.mesh.face[h / 3];
        const double length = length_of(strip.mesh, face[h % 3], face[(h % 3 + 1) % 3]);
        if (opposite[h] == kBorderEdge)
            clusters_[strip.face_plane[h / 3]].mesh_border += length;
        else if (opposite[h] != kNonManifoldEdge && h < opposite[h])
            add(strip.face_plane[h / 3], strip.face_plane[opposite[h] / 3], length);
    }
    const auto fans = fans_of(strip);
    for (std::size_t i = 0; i < fans.size(); ++i)
        for (std::size_t j = i + 1; j < fans.size() && fans[j].vertices == fans[i].vertices; ++j)
            add(fans[i].plane, fans[j].plane, length_of(strip.mesh, fans[i].vertices.first, fans[i].vertices.second));
}

double NeighbourGraph::energy(const Moments& sum) const { return pca_energy(sum, flat_variance_); }

void NeighbourGraph::refresh(Cluster& cluster) const
{
    cluster.energy = energy(cluster.sum);
    cluster.plane = fit_plane(cluster.sum);
    if (cluster.plane.normal.dot(cluster.facing) < 0.0) cluster.plane = cluster.plane.flipped();
}

void NeighbourGraph::join(PlaneId into, PlaneId from)
{
    Cluster& cluster = clusters_[into];
    cluster.sum += clusters_[from].sum;
    cluster.facing += clusters_[from].facing;
    cluster.mesh_border += clusters_[from].mesh_border;
    ++cluster.version;
    refresh(cluster);
    parent_[from] = into;
    borders_[into].erase(from);
    for (const auto& [other, length] : borders_[from]) {
        borders_[other].erase(from);
        if (other == into) continue;
        borders_[into][other] += length;
        borders_[other][into] += length;
    }
    borders_[from].clear();
}

std::vector<PlaneId> NeighbourGraph::roots() const
{
    std::vector<PlaneId> root(parent_);
    for (PlaneId p = 0; p < root.size(); ++p)
        while (parent_[root[p]] != root[p])
            root[p] = parent_[root[p]];
    return root;
}

} // namespace quoin
