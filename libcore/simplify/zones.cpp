#include "simplify/zones.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <numeric>

namespace quoin {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

} // namespace

Zones::Zones(PlaneMesh mesh, std::vector<std::uint32_t> opposite)
    : mesh_(std::move(mesh)), opposite_(std::move(opposite)), plane_of_(mesh_.plane.size()),
      faces_(mesh_.plane.size(), 0), failed_(mesh_.plane.size(), 0), rough_(mesh_.plane.size(), 0),
      pending_(mesh_.plane.size(), 1), noted_(mesh_.plane.size(), 0), mark_(mesh_.face_plane.size(), 0)
{
    std::iota(plane_of_.begin(), plane_of_.end(), 0u);
    separate_pieces();
    border_ = border_half_edges(mesh_, opposite_);
}

// The pieces of planes beside the largest become zones of their own.
void Zones::separate_pieces()
{
    const auto count = static_cast<FaceId>(mesh_.face_plane.size());
    UnionFind pieces(count);
    for (std::uint32_t h = 0; h < 3 * count; ++h) {
        const std::uint32_t o = opposite_[h];
        if (!is_half_edge(o) || o > h || mesh_.face_plane[o / 3] != mesh_.face_plane[h / 3]) continue;
        const std::uint32_t a = pieces.find(h / 3), b = pieces.find(o / 3);
        if (a != b) pieces.join(std::min(a, b), std::max(a, b));
    }
    std::vector<FaceId> largest(size(), kNone); // root
    std::vector<FaceId> piece(count, 0);        // faces, at the root
    for (FaceId f = 0; f < count; ++f)
        ++piece[pieces.find(f)];
    for (FaceId f = 0; f < count; ++f) {
        FaceId& root = largest[mesh_.face_plane[f]];
        if (piece[f] > 0 && (root == kNone || piece[f] > piece[root])) root = f;
    }
    std::vector<PlaneId> zone(count, kNoPlane); // of a piece that is taken out, at its root
    for (FaceId f = 0; f < count; ++f) {
        PlaneId& here = mesh_.face_plane[f];
        const FaceId root = pieces.find(f);
        if (f == root && root != largest[here]) zone[f] = add_zone(here);
        if (zone[root] != kNoPlane) here = zone[root];
        ++faces_[here];
    }
}

std::size_t Zones::rough_count() const
{
    return static_cast<std::size_t>(std::count(rough_.begin(), rough_.end(), std::uint8_t{1}));
}

ZonePart Zones::part()
{
    note_rough_zones();
    ZonePart part;
    std::vector<std::uint32_t> border;
    for (const std::uint32_t h : border_) {
        const std::uint32_t o = opposite_[h];
        if (pending(mesh_.face_plane[h / 3]) || (o != kBorderEdge && pending(mesh_.face_plane[o / 3])))
            border.push_back(h);
    }
    part.curves = trace_curves(mesh_, opposite_, border);
    part.mesh.plane = mesh_.plane;
    part.mesh.moments = mesh_.moments;
    part.dense = part.curves.vertex;
    std::sort(part.dense.begin(), part.dense.end());
    part.dense.erase(std::unique(part.dense.begin(), part.dense.end()), part.dense.end());
    for (const VertexId v : part.dense) {
        part.mesh.mesh.position.push_back(mesh_.mesh.position[v]);
        part.mesh.vertex_class.push_back(mesh_.vertex_class[v]);
    }
    for (VertexId& v : part.curves.vertex)
        v = part.index(v);
    part.rough_edge = rough_edges(part);
    return part;
}

// Vertices inside a rough zone stay inside it, so that no edge is missed.
void Zones::note_edges(FaceId f)
{
    const auto inner = [&](VertexId v) { return mesh_.vertex_class[v] == VertexClass::Inner; };
    for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
        if (const auto [a, b] = ends(h); !inner(a) && !inner(b)) rough_edge_.push_back({a, b});
}

// Zones that were given up as a whole; edges of knots are noted as they are cut out.
void Zones::note_rough_zones()
{
    if (noted_ == rough_) return;
    for (FaceId f = 0; f < mesh_.face_plane.size(); ++f)
        if (const PlaneId zone = mesh_.face_plane[f]; rough(zone) && !noted_[zone]) note_edges(f);
    noted_ = rough_;
}

std::vector<std::array<VertexId, 2>> Zones::rough_edges(const ZonePart& part) const
{
    const auto corner = [&](VertexId v) { return mesh_.vertex_class[v] == VertexClass::Corner; };
    std::vector<std::array<VertexId, 2>> edges;
    for (const auto& [a, b] : rough_edge_) {
        if (!corner(a) || !corner(b) || !part.has(a) || !part.has(b)) continue;
        const auto [low, high] = std::minmax({part.index(a), part.index(b)}); // by value
        edges.push_back({low, high});
    }
    return edges;
}

PlaneId Zones::add_zone(PlaneId from)
{
    mesh_.plane.push_back(mesh_.plane[from]);
    mesh_.moments.push_back(mesh_.moments[from]);
    plane_of_.push_back(plane_of_[from]);
    faces_.push_back(0);
    failed_.push_back(failed_[from]);
    rough_.push_back(0);
    noted_.push_back(0);
    pending_.push_back(1);
    return static_cast<PlaneId>(size() - 1);
}

void Zones::join(PlaneMesh& mesh) const
{
    PlaneId planes = 0;
    while (planes < size() && plane_of_[planes] == planes)
        ++planes;
    for (PlaneId& p : mesh.face_plane)
        p = plane_of_[p];
    mesh.plane.resize(planes);
    mesh.moments.resize(planes);
}

} // namespace quoin
