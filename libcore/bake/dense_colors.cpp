#include "bake/dense_colors.h"

#include "base/parallel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace quoin {
namespace {

constexpr int kRings = 3;        // cells on every side at the farthest look-up
constexpr float kNearest = 0.1f; // distances below this part of a cell count alike

using Cell = Eigen::Vector3i;

std::uint64_t key(const Cell& cell)
{
    constexpr std::uint64_t kBits = 21, kMask = (std::uint64_t{1} << kBits) - 1;
    const auto part = [&](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) & kMask; };
    return part(cell.x()) | part(cell.y()) << kBits | part(cell.z()) << (2 * kBits);
}

Cell cell_of(const Eigen::Vector3f& p, float size) { return (p / size).array().floor().cast<int>(); }

std::vector<Eigen::Vector3f> vertex_normals(const TriangleMesh& mesh)
{
    if (!mesh.normal.empty()) return mesh.normal;
    std::vector<Eigen::Vector3f> normal(mesh.position.size(), Eigen::Vector3f::Zero());
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        for (const VertexId v : mesh.face[f])
            normal[v] += area_vector(mesh, f).cast<float>();
    for (auto& n : normal)
        n.normalize();
    return normal;
}

} // namespace

DenseColors::DenseColors(const TriangleMesh& dense, double radius)
    : dense_(dense), cell_(static_cast<float>(radius / kRings)), normal_(vertex_normals(dense))
{
    std::vector<std::uint64_t> keys(dense.position.size());
    for (std::size_t v = 0; v < keys.size(); ++v)
        keys[v] = key(cell_of(dense.position[v], cell_));
    vertex_.resize(keys.size());
    std::iota(vertex_.begin(), vertex_.end(), VertexId{0});
    std::ranges::sort(vertex_, [&](VertexId a, VertexId b) { return std::pair(keys[a], a) < std::pair(keys[b], b); });
    for (std::uint32_t begin = 0, end = 0; begin < vertex_.size(); begin = end) {
        while (end < vertex_.size() && keys[vertex_[end]] == keys[vertex_[begin]])
            ++end;
        cells_.emplace(keys[vertex_[begin]], Range{begin, end});
    }
}

// All vertices nearer than `rings` cells; their weight falls to 0 there, so that none jumps in.
std::optional<Eigen::Vector3f> DenseColors::within(int rings, const Eigen::Vector3f& p,
                                                   const Eigen::Vector3f& normal) const
{
    const float radius = static_cast<float>(rings) * cell_;
    const float least = kNearest * cell_ * kNearest * cell_;
    const Cell centre = cell_of(p, cell_);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float total = 0.0f;
    for (int i = 0, side = 2 * rings + 1; i < side * side * side; ++i) {
        const Cell cell = centre + Cell(i % side - rings, i / side % side - rings, i / (side * side) - rings);
        const auto found = cells_.find(key(cell));
        if (found == cells_.end()) continue;
        for (auto j = found->second.begin; j < found->second.end; ++j) {
            const VertexId v = vertex_[j];
            const float distance = (dense_.position[v] - p).norm();
            if (distance >= radius || normal_[v].dot(normal) <= 0.0f) continue;
            const float ramp = 1.0f - distance / radius;
            const float weight = ramp * ramp / (distance * distance + least);
            sum += weight * Eigen::Vector3f(dense_.color[v][0], dense_.color[v][1], dense_.color[v][2]);
            total += weight;
        }
    }
    if (total <= 0.0f) return std::nullopt;
    return sum / total;
}

std::optional<Eigen::Vector3f> DenseColors::at(const Eigen::Vector3d& p_world,
                                               const Eigen::Vector3d& normal_world) const
{
    for (int rings = 1; rings <= kRings; ++rings)
        if (auto color = within(rings, p_world.cast<float>(), normal_world.cast<float>())) return color;
    return std::nullopt;
}

} // namespace quoin
