#include "mesh/cleanup.h"

#include "geometry/radix_sort.h"
#include "geometry/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/fans.h"
#include "mesh/morton.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace quoin {
namespace {

constexpr VertexId kNoVertex = 0xffffffffu;
constexpr std::uint32_t kMortonCells = (1u << 21) - 1;

// Removes the faces for which drop(f) holds; returns their number.
template <class Drop>
std::size_t remove_faces(TriangleMesh& mesh, const Drop& drop)
{
    std::size_t kept = 0;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        if (!drop(f)) mesh.face[kept++] = mesh.face[f];
    const std::size_t removed = mesh.face.size() - kept;
    mesh.face.resize(kept);
    return removed;
}

template <class T>
void gather(std::vector<T>& values, const std::vector<VertexId>& source)
{
    if (values.empty()) return;
    std::vector<T> gathered(source.size());
    for (std::size_t v = 0; v < source.size(); ++v)
        gathered[v] = values[source[v]];
    values.swap(gathered);
}

// New vertex v is old vertex source[v].
void gather_vertices(TriangleMesh& mesh, const std::vector<VertexId>& source)
{
    gather(mesh.position, source);
    gather(mesh.color, source);
    gather(mesh.normal, source);
}

// Cells of a grid over the bounding box.
class Cells {
public:
    // At least `size` [m] a cell, and no more cells than a Morton code has.
    Cells(const TriangleMesh& mesh, double size)
    {
        Eigen::AlignedBox3f box;
        for (const auto& p : mesh.position)
            if (p.allFinite()) box.extend(p);
        if (box.isEmpty()) return;
        origin_ = box.min().cast<double>();
        const double extent = box.sizes().cast<double>().maxCoeff();
        size_ = std::max({size, extent / kMortonCells, std::numeric_limits<double>::min()});
    }

    std::array<std::uint32_t, 3> of(const Eigen::Vector3f& p) const
    {
        const Eigen::Vector3d cell = (p.cast<double>() - origin_) / size_;
        const auto clamped = [](double c) {
            return static_cast<std::uint32_t>(c > 0.0 ? std::min(c, double(kMortonCells)) : 0.0);
        };
        return {clamped(cell.x()), clamped(cell.y()), clamped(cell.z())};
    }

    // Calls visit(morton code) for the cell of p and those around it.
    template <class Visit>
    void for_neighbours(const Eigen::Vector3f& p, const Visit& visit) const
    {
        const auto [x, y, z] = of(p);
        for (std::uint32_t i = 0; i < 27; ++i) {
            const std::uint32_t nx = x + i % 3 - 1, ny = y + i / 3 % 3 - 1, nz = z + i / 9 - 1;
            if (std::max({nx, ny, nz}) <= kMortonCells)
                visit(morton_code(nx, ny, nz)); // -1 wraps round to a large value
        }
    }

private:
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    double size_ = 1.0;
};

std::vector<Keyed> sorted_by_cell(const TriangleMesh& mesh, const Cells& cells)
{
    std::vector<Keyed> items(mesh.position.size());
    for (VertexId v = 0; v < items.size(); ++v) {
        const auto [x, y, z] = cells.of(mesh.position[v]);
        items[v] = {morton_code(x, y, z), v};
    }
    radix_sort(items);
    return items;
}

// Calls visit(u) for the vertices of a cell.
template <class Visit>
void for_vertices_in_cell(const std::vector<Keyed>& items, std::uint64_t key, const Visit& visit)
{
    auto it = std::lower_bound(items.begin(), items.end(), key,
                               [](const Keyed& item, std::uint64_t k) { return item.key < k; });
    for (; it != items.end() && it->key == key; ++it)
        visit(it->item);
}

// For every vertex the vertex it is merged into: the first one at the same position.
std::vector<VertexId> first_equal(const TriangleMesh& mesh)
{
    std::vector<VertexId> target(mesh.position.size());
    std::iota(target.begin(), target.end(), 0u);
    std::vector<VertexId> order = target;
    std::erase_if(order, [&](VertexId v) { return !mesh.position[v].allFinite(); });
    std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
        const auto &p = mesh.position[a], &q = mesh.position[b];
        return std::tuple(p.x(), p.y(), p.z(), a) < std::tuple(q.x(), q.y(), q.z(), b);
    });
    for (std::size_t i = 1; i < order.size(); ++i)
        if (mesh.position[order[i]] == mesh.position[order[i - 1]]) target[order[i]] = target[order[i - 1]];
    return target;
}

// The same: the first one within the tolerance that stays. Cells are as large as the tolerance, so 27 of them hold it.
std::vector<VertexId> first_within(const TriangleMesh& mesh, double tolerance)
{
    const Cells cells(mesh, tolerance);
    const auto items = sorted_by_cell(mesh, cells);
    const auto squared = static_cast<float>(tolerance * tolerance);
    std::vector<VertexId> target(mesh.position.size());
    for (VertexId v = 0; v < target.size(); ++v) {
        const Eigen::Vector3f& p = mesh.position[v];
        VertexId best = v;
        cells.for_neighbours(p, [&](std::uint64_t key) {
            auto it = std::lower_bound(items.begin(), items.end(), key,
                                       [](const Keyed& i, std::uint64_t k) { return i.key < k; });
            for (; it != items.end() && it->key == key && it->item < best; ++it) { // ascending within a cell
                const VertexId u = it->item;
                if (target[u] == u && (mesh.position[u] - p).squaredNorm() <= squared) best = u;
            }
        });
        target[v] = best;
    }
    return target;
}

Face sorted(Face face)
{
    std::sort(face.begin(), face.end());
    return face;
}

} // namespace

std::size_t drop_non_finite(TriangleMesh& mesh)
{
    const auto finite = [&](VertexId v) { return mesh.position[v].allFinite(); };
    std::size_t count = 0;
    for (VertexId v = 0; v < mesh.position.size(); ++v)
        count += finite(v) ? 0 : 1;
    if (count > 0) {
        remove_faces(mesh, [&](FaceId f) {
            const Face& face = mesh.face[f];
            return !(finite(face[0]) && finite(face[1]) && finite(face[2]));
        });
    }
    return count;
}

std::size_t weld_vertices(TriangleMesh& mesh, double tolerance)
{
    const auto target = tolerance > 0.0 ? first_within(mesh, tolerance) : first_equal(mesh);
    std::size_t merged = 0;
    for (VertexId v = 0; v < target.size(); ++v)
        merged += target[v] != v ? 1 : 0;
    for (auto& face : mesh.face)
        for (auto& v : face)
            v = target[v];
    return merged;
}

std::size_t drop_degenerate_faces(TriangleMesh& mesh)
{
    return remove_faces(mesh, [&](FaceId f) {
        const auto [a, b, c] = mesh.face[f];
        return a == b || b == c || c == a || area_vector(mesh, f).isZero(0.0);
    });
}

std::size_t drop_duplicate_faces(TriangleMesh& mesh)
{
    // Faces of the same smallest vertex form one short run; only those are compared.
    std::vector<std::uint32_t> start(mesh.position.size() + 1, 0);
    for (const auto& face : mesh.face)
        ++start[sorted(face)[0] + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> end(start.begin(), start.end());
    std::vector<Face> seen(mesh.face.size());
    return remove_faces(mesh, [&](FaceId f) {
        const Face face = sorted(mesh.face[f]);
        const auto first = seen.begin() + start[face[0]], last = seen.begin() + end[face[0]];
        if (std::find(first, last, face) != last) return true;
        seen[end[face[0]]++] = face;
        return false;
    });
}

RemovedComponents drop_small_components(TriangleMesh& mesh, std::size_t min_faces, double min_area)
{
    const auto component = face_components(mesh);
    const std::size_t count = component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1;
    std::vector<std::size_t> faces(count, 0);
    std::vector<double> area(count, 0.0);
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        ++faces[component[f]];
        area[component[f]] += face_area(mesh, f);
    }
    const auto small = [&](std::size_t c) { return faces[c] < min_faces || area[c] < min_area; };
    RemovedComponents removed;
    for (std::size_t c = 0; c < count; ++c)
        removed.components += small(c) ? 1 : 0;
    removed.faces = remove_faces(mesh, [&](FaceId f) { return small(component[f]); });
    return removed;
}

std::size_t split_touching_fans(TriangleMesh& mesh) { return split_touching_fans(mesh, opposite_half_edges(mesh)); }

std::size_t remove_isolated_vertices(TriangleMesh& mesh)
{
    std::vector<std::uint8_t> used(mesh.position.size(), 0);
    for (const auto& face : mesh.face)
        for (const VertexId v : face)
            used[v] = 1;
    std::vector<VertexId> name(mesh.position.size(), kNoVertex), source;
    for (VertexId v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        name[v] = static_cast<VertexId>(source.size());
        source.push_back(v);
    }
    const std::size_t removed = used.size() - source.size();
    if (removed == 0) return 0;
    for (auto& face : mesh.face)
        for (auto& v : face)
            v = name[v];
    gather_vertices(mesh, source);
    return removed;
}

void sort_along_morton(TriangleMesh& mesh)
{
    const auto items = sorted_by_cell(mesh, Cells(mesh, 0.0));
    std::vector<VertexId> source(items.size()), name(items.size());
    for (VertexId v = 0; v < items.size(); ++v) {
        source[v] = items[v].item;
        name[items[v].item] = v;
    }
    gather_vertices(mesh, source);
    for (auto& face : mesh.face)
        for (auto& v : face)
            v = name[v];

    std::vector<std::uint32_t> start(mesh.position.size() + 1, 0);
    const auto first_vertex = [](const Face& face) { return std::min({face[0], face[1], face[2]}); };
    for (const auto& face : mesh.face)
        ++start[first_vertex(face) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Face> ordered(mesh.face.size());
    for (const auto& face : mesh.face)
        ordered[start[first_vertex(face)]++] = face;
    mesh.face.swap(ordered);
}

CleanupReport clean_up(TriangleMesh& mesh, const CleanupParams& params)
{
    CleanupReport report;
    report.non_finite_vertices = drop_non_finite(mesh);
    report.welded_vertices = weld_vertices(mesh, params.weld_tolerance);
    report.degenerate_faces = drop_degenerate_faces(mesh);
    report.duplicate_faces = drop_duplicate_faces(mesh);
    report.small =
        drop_small_components(mesh, static_cast<std::size_t>(params.min_component_faces), params.min_component_area);
    report.split_vertices = split_touching_fans(mesh);
    report.isolated_vertices = remove_isolated_vertices(mesh);
    sort_along_morton(mesh);
    return report;
}

} // namespace quoin
