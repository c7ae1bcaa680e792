#include "simplify/zones.h"

#include "base/parallel.h"
#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <numeric>

namespace quoin {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::size_t kFaceGrain = 1 << 14;
constexpr std::size_t kBlockFaces = 1 << 16;

// Of every face the first one of its connected piece of a plane. Blocks of faces are joined among themselves first;
// meshes are in Morton order, so that few edges run between them.
std::vector<FaceId> first_of_pieces(const std::vector<PlaneId>& face_plane, const std::vector<std::uint32_t>& opposite)
{
    UnionFind pieces(face_plane.size());
    const auto join_across = [&](std::uint32_t h) {
        const std::uint32_t o = opposite[h];
        if (face_plane[o / 3] != face_plane[h / 3]) return;
        const std::uint32_t a = pieces.find(h / 3), b = pieces.find(o / 3);
        if (a != b) pieces.join(std::min(a, b), std::max(a, b));
    };
    const auto join_within = [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> leaving;
        for (auto h = static_cast<std::uint32_t>(3 * begin); h < 3 * end; ++h) {
            const std::uint32_t o = opposite[h];
            if (!is_half_edge(o) || o > h) continue;
            if (o >= 3 * begin)
                join_across(h);
            else
                leaving.push_back(h);
        }
        return leaving;
    };
    const auto append = [](std::vector<std::uint32_t> all, const std::vector<std::uint32_t>& more) {
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    for (const std::uint32_t h :
         parallel_reduce(face_plane.size(), kBlockFaces, std::vector<std::uint32_t>(), join_within, append))
        join_across(h);
    std::vector<FaceId> first(face_plane.size());
    parallel_for(
        first.size(), [&](std::size_t f) { first[f] = pieces.root(static_cast<FaceId>(f)); }, kFaceGrain);
    return first;
}

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
    const std::vector<FaceId> first = first_of_pieces(mesh_.face_plane, opposite_);
    std::vector<FaceId> piece(count, 0); // faces, at the first
    for (const FaceId f : first)
        ++piece[f];
    const auto roots = parallel_select<FaceId>(count, kFaceGrain, [&](std::size_t f) { return first[f] == f; });
    std::vector<FaceId> largest(size(), kNone); // first of it
    for (const FaceId f : roots)
        if (FaceId& root = largest[mesh_.face_plane[f]]; root == kNone || piece[f] > piece[root]) root = f;
    std::vector<PlaneId> zone(count); // of the piece, at its first
    for (const FaceId f : roots) {
        const PlaneId here = mesh_.face_plane[f];
        zone[f] = f == largest[here] ? here : add_zone(here);
        faces_[zone[f]] = piece[f];
    }
    parallel_for(
        count, [&](std::size_t f) { mesh_.face_plane[f] = zone[first[f]]; }, kFaceGrain);
}

std::size_t Zones::rough_count() const
{
    return static_cast<std::size_t>(std::count(rough_.begin(), rough_.end(), std::uint8_t{1}));
}

ZonePart Zones::part() const
{
    ZonePart part;
    std::vector<std::uint32_t> border;
    for (const auto i : parallel_select<std::uint32_t>(border_.size(), kFaceGrain, [&](std::size_t b) {
             const std::uint32_t h = border_[b], o = opposite_[h];
             return pending(mesh_.face_plane[h / 3]) || (o != kBorderEdge && pending(mesh_.face_plane[o / 3]));
         }))
        border.push_back(border_[i]);
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
    const auto is_new = [&](PlaneId zone) { return rough(zone) && !noted_[zone]; };
    for (const FaceId f : parallel_select<FaceId>(mesh_.face_plane.size(), kFaceGrain,
                                                  [&](std::size_t i) { return is_new(mesh_.face_plane[i]); }))
        note_edges(f);
    noted_ = rough_;
}

void Zones::add_rough_edges(ZonePart& part)
{
    note_rough_zones();
    const auto corner = [&](VertexId v) { return mesh_.vertex_class[v] == VertexClass::Corner; };
    for (const auto& [a, b] : rough_edge_) {
        if (!corner(a) || !corner(b) || !part.has(a) || !part.has(b)) continue;
        const auto [low, high] = std::minmax({part.index(a), part.index(b)}); // by value
        part.rough_edge.push_back({low, high});
    }
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
