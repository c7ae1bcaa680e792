#include "simplify/clean.h"

#include "base/parallel.h"
#include "geometry/radix_sort.h"
#include "geometry/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/cleanup.h"
#include "mesh/fans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>

namespace quoin {
namespace {

constexpr std::size_t kGrain = 1 << 14;   // [vertices, faces]
constexpr std::size_t kSlotsOfVertex = 8; // of a table of hashes: one vertex in so many is not alone by chance

struct Cell {
    std::array<std::int64_t, 3> at{};
    VertexId vertex = 0;
};

// nullopt: outside of all numbers of cells.
std::optional<Cell> cell_of(const TriangleMesh& mesh, VertexId v, double distance)
{
    const Eigen::Vector3d p = (mesh.position[v].cast<double>() / distance).array().round();
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 9e18) return {};
    return Cell{{std::llround(p.x()), std::llround(p.y()), std::llround(p.z())}, v};
}

// Spread evenly.
std::uint32_t hash_of(const Cell& cell)
{
    std::uint64_t hash = 0;
    for (const std::int64_t at : cell.at)
        hash = (hash ^ static_cast<std::uint64_t>(at)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::uint32_t>(hash >> 32);
}

// Names the vertices of each cell after the first of them.
void name_by_cell(std::vector<Cell>& cells, std::vector<VertexId>& name)
{
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return std::tie(a.at, a.vertex) < std::tie(b.at, b.vertex); });
    for (std::size_t i = 1; i < cells.size(); ++i)
        if (cells[i].at == cells[i - 1].at) name[cells[i].vertex] = name[cells[i - 1].vertex];
}

// Of every vertex the hash of its cell.
std::vector<std::uint32_t> cell_hashes(const TriangleMesh& mesh, double distance)
{
    std::vector<std::uint32_t> hash(mesh.position.size());
    parallel_for(
        hash.size(),
        [&](std::size_t v) {
            const auto cell = cell_of(mesh, static_cast<VertexId>(v), distance);
            hash[v] = cell ? hash_of(*cell) : 0;
        },
        kGrain);
    return hash;
}

// Vertices whose hash ends like that of another one: those that share a cell, and a few that do not.
std::vector<VertexId> not_alone(const std::vector<std::uint32_t>& hash)
{
    const std::size_t mask = std::bit_ceil(kSlotsOfVertex * hash.size() + 1) - 1;
    std::vector<bool> seen(mask + 1), seen_again(mask + 1); // bits, for all of it is looked at in no order
    for (const std::uint32_t h : hash) {
        if (seen[h & mask]) seen_again[h & mask] = true;
        seen[h & mask] = true;
    }
    return parallel_select<VertexId>(hash.size(), kGrain, [&](std::size_t v) { return seen_again[hash[v] & mask]; });
}

// For every vertex the smallest id in its grid cell.
std::vector<VertexId> weld_map(const TriangleMesh& mesh, double distance)
{
    std::vector<VertexId> name(mesh.position.size());
    std::iota(name.begin(), name.end(), 0u);
    const auto hash = cell_hashes(mesh, distance);
    std::vector<Keyed> keys;
    for (const VertexId v : not_alone(hash))
        if (cell_of(mesh, v, distance)) keys.push_back({hash[v], v});
    radix_sort(keys);
    std::vector<Cell> cells;
    for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
        for (end = begin + 1; end < keys.size() && keys[end].key == keys[begin].key;)
            ++end;
        if (end == begin + 1) continue;
        cells.clear();
        for (std::size_t i = begin; i < end; ++i)
            cells.push_back(*cell_of(mesh, keys[i].item, distance));
        name_by_cell(cells, name);
    }
    return name;
}

Face sorted(Face face)
{
    std::sort(face.begin(), face.end());
    return face;
}

bool usable(const TriangleMesh& mesh, const Face& face)
{
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) return false;
    return std::all_of(face.begin(), face.end(), [&](VertexId v) { return mesh.position[v].allFinite(); });
}

template <class Keep>
void keep_faces(PlaneMesh& mesh, const Keep& keep)
{
    if (parallel_all_of(mesh.mesh.face.size(), kGrain, keep)) return;
    std::size_t count = 0;
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        if (!keep(f)) continue;
        mesh.mesh.face[count] = mesh.mesh.face[f];
        mesh.face_plane[count++] = mesh.face_plane[f];
    }
    mesh.mesh.face.resize(count);
    mesh.face_plane.resize(count);
}

// Does an earlier face have the same vertices?
std::vector<std::uint8_t> repeated_faces(const TriangleMesh& mesh)
{
    const auto around = vertex_faces(mesh);
    std::vector<std::uint8_t> repeated(mesh.face.size(), 0);
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        for (const FaceId g : around.of(mesh.face[f][0])) {
            if (g >= f) break;
            if (sorted(mesh.face[f]) == sorted(mesh.face[g])) repeated[f] = 1;
        }
    }
    return repeated;
}

// An edge of a face as it is sorted: faces of one edge side by side, those of one plane next to each other.
struct CrowdedUse {
    VertexId low = 0, high = 0;
    PlaneId plane = 0;
    std::uint32_t half_edge = 0;
    bool upwards = false;
};

class FanSplitter {
public:
    FanSplitter(PlaneMesh& mesh, std::vector<std::uint32_t> opposite)
        : mesh_(mesh), opposite_(std::move(opposite)), corners_(3 * mesh.mesh.face.size())
    {
    }

    // Returns the opposites of the half-edges afterwards.
    std::vector<std::uint32_t> split()
    {
        const std::size_t vertices = mesh_.mesh.position.size();
        join_fans();
        std::vector<std::uint8_t> taken(mesh_.mesh.position.size(), 0);
        std::vector<VertexId> vertex(corners_count(), 0); // of the fan with that root
        for (std::uint32_t c = 0; c < corners_count(); ++c) {
            VertexId& v = mesh_.mesh.face[c / 3][c % 3];
            const std::uint32_t root = corners_.find(c);
            if (root == c) vertex[c] = taken[v] ? copy_of(v) : v;
            if (root == c && !taken[v]) taken[v] = 1;
            v = vertex[root];
        }
        return mesh_.mesh.position.size() == vertices ? std::move(opposite_) : opposite_half_edges(mesh_.mesh);
    }

private:
    std::uint32_t corners_count() const { return static_cast<std::uint32_t>(3 * mesh_.mesh.face.size()); }

    void join_fans()
    {
        std::vector<CrowdedUse> crowded;
        for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
            if (opposite_[h] == kNonManifoldEdge)
                crowded.push_back(use_of(h));
            else if (opposite_[h] != kBorderEdge && h < opposite_[h])
                join(h, opposite_[h]);
        }
        std::sort(crowded.begin(), crowded.end(), [](const CrowdedUse& a, const CrowdedUse& b) {
            return std::tie(a.low, a.high, a.plane, a.half_edge) < std::tie(b.low, b.high, b.plane, b.half_edge);
        });
        for (std::size_t begin = 0, end = 0; begin < crowded.size(); begin = end) {
            while (end < crowded.size() && crowded[end].low == crowded[begin].low &&
                   crowded[end].high == crowded[begin].high)
                ++end;
            join_pairs(std::span(crowded).subspan(begin, end - begin));
        }
    }

    // Of the faces on one edge, those of one plane; then those around one inside, which begins behind a face that runs
    // down the edge and, turning about that, ends behind the next one that runs up.
    void join_pairs(std::span<const CrowdedUse> uses)
    {
        std::vector<std::size_t> left;
        for (std::size_t i = 0; i < uses.size(); ++i) {
            const bool pair =
                i + 1 < uses.size() && uses[i].plane == uses[i + 1].plane && uses[i].upwards != uses[i + 1].upwards;
            if (!pair)
                left.push_back(i);
            else
                join(uses[i].half_edge, uses[i + 1].half_edge);
            i += pair ? 1 : 0;
        }
        sort_around_edge(uses, left);
        std::vector<std::size_t> begun;
        std::vector<std::uint8_t> joined(uses.size(), 0);
        for (const int turn : {0, 1})
            for (const std::size_t i : left) {
                if (!uses[i].upwards) {
                    if (turn == 0) begun.push_back(i);
                } else if (!joined[i] && !begun.empty()) {
                    joined[i] = 1;
                    join(uses[begun.back()].half_edge, uses[i].half_edge);
                    begun.pop_back();
                }
            }
    }

    void sort_around_edge(std::span<const CrowdedUse> uses, std::vector<std::size_t>& which) const
    {
        const Eigen::Vector3d origin = position(uses[0].low), along = (position(uses[0].high) - origin).normalized(),
                              x = along.unitOrthogonal(), y = along.cross(x);
        std::vector<double> angle;
        for (const CrowdedUse& use : uses) {
            const Eigen::Vector3d apex = corner(mesh_.mesh, use.half_edge / 3, (use.half_edge % 3 + 2) % 3);
            angle.push_back(std::atan2(y.dot(apex - origin), x.dot(apex - origin)));
        }
        std::ranges::stable_sort(which, {}, [&](std::size_t i) { return angle[i]; });
    }

    Eigen::Vector3d position(VertexId v) const { return mesh_.mesh.position[v].cast<double>(); }

    CrowdedUse use_of(std::uint32_t h) const
    {
        const VertexId a = mesh_.mesh.face[h / 3][h % 3], b = mesh_.mesh.face[h / 3][(h % 3 + 1) % 3];
        return {std::min(a, b), std::max(a, b), mesh_.face_plane[h / 3], h, a < b};
    }

    void join(std::uint32_t h, std::uint32_t o)
    {
        for (const std::uint32_t c : {h, h / 3 * 3 + (h % 3 + 1) % 3}) {
            const auto& face = mesh_.mesh.face[o / 3];
            const VertexId v = mesh_.mesh.face[c / 3][c % 3];
            const auto d =
                o / 3 * 3 + static_cast<std::uint32_t>(std::find(face.begin(), face.end(), v) - face.begin());
            const std::uint32_t r = corners_.find(c), s = corners_.find(d);
            if (r != s) corners_.join(std::min(r, s), std::max(r, s));
        }
    }

    VertexId copy_of(VertexId v)
    {
        auto& mesh = mesh_.mesh;
        mesh.position.push_back(mesh.position[v]);
        if (!mesh.color.empty()) mesh.color.push_back(mesh.color[v]);
        return static_cast<VertexId>(mesh.position.size() - 1);
    }

    PlaneMesh& mesh_;
    std::vector<std::uint32_t> opposite_;
    UnionFind corners_;
};

void drop_empty_planes(PlaneMesh& mesh)
{
    std::vector<PlaneId> name(mesh.plane.size(), 0);
    for (const PlaneId p : mesh.face_plane)
        name[p] = 1;
    PlaneId count = 0;
    for (PlaneId p = 0; p < name.size(); ++p) {
        if (name[p] == 0) continue;
        mesh.plane[count] = mesh.plane[p];
        mesh.moments[count] = mesh.moments[p];
        name[p] = count++;
    }
    mesh.plane.resize(count);
    mesh.moments.resize(count);
    for (auto& p : mesh.face_plane)
        p = name[p];
}

} // namespace

std::vector<std::uint32_t> clean_input(PlaneMesh& mesh, const SimplifyParams& params)
{
    if (params.weld_distance > 0.0) {
        const auto name = weld_map(mesh.mesh, params.weld_distance);
        parallel_for(
            mesh.mesh.face.size(),
            [&](std::size_t f) {
                for (auto& v : mesh.mesh.face[f])
                    v = name[v];
            },
            kGrain);
    }
    keep_faces(mesh, [&](std::size_t f) { return usable(mesh.mesh, mesh.mesh.face[f]); });
    mesh.mesh.normal.clear();
    auto opposite = opposite_half_edges(mesh.mesh);
    if (!faces_that_may_repeat(opposite).empty()) {
        const auto repeated = repeated_faces(mesh.mesh);
        keep_faces(mesh, [&](std::size_t f) { return repeated[f] == 0; });
        opposite = opposite_half_edges(mesh.mesh);
    }
    if (parallel_all_of(opposite.size(), kGrain, [&](std::size_t h) { return opposite[h] != kNonManifoldEdge; })) {
        split_touching_fans(mesh.mesh, opposite);
        return opposite;
    }
    return FanSplitter(mesh, std::move(opposite)).split();
}

void finish(PlaneMesh& mesh, const SimplifyParams& params, PlaneParts parts)
{
    FanSplitter(mesh, opposite_half_edges(mesh.mesh)).split();
    separate_parts(mesh, params.snap_distance, parts);
    remove_isolated_vertices(mesh.mesh);
    drop_empty_planes(mesh);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
}

} // namespace quoin
