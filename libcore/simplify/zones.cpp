#include "simplify/zones.h"

#include "base/parallel.h"
#include "geometry/union_find.h"
#include "mesh/adjacency.h"
#include "simplify/surroundings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace quoin {
namespace {

constexpr std::uint8_t kMostCuts = 6;  // of a zone
constexpr double kFirstReach = 2.0;    // around a knot, in errors of borders
constexpr int kMostDoublings = 2;      // of the reach, one with every cut
constexpr std::size_t kMostOfZone = 2; // a cut takes less than one in so many of a zone's faces
constexpr std::uint32_t kNone = 0xffffffffu;

} // namespace

// The faces that one failure would take out of its zone.
struct Zones::Cut {
    const Failure* failure = nullptr;
    double reach = 0.0;       // [m]; 0: it has failed too often
    std::vector<FaceId> all;  // faces of the zone
    std::vector<FaceId> face; // those to take out
};

Zones::Zones(PlaneMesh mesh, std::vector<std::uint32_t> opposite)
    : mesh_(std::move(mesh)), opposite_(std::move(opposite)), plane_of_(mesh_.plane.size()),
      failed_(mesh_.plane.size(), 0), rough_(mesh_.plane.size(), 0), pending_(mesh_.plane.size(), 1),
      index_(mesh_.face_plane.size())
{
    std::iota(plane_of_.begin(), plane_of_.end(), 0u);
    std::vector<FaceId> all(index_.size()), relabelled;
    std::iota(all.begin(), all.end(), 0u);
    separate(all, relabelled);
    border_ = border_half_edges(mesh_, opposite_);
    mesh_.vertex_class = classify_vertices(mesh_.mesh, mesh_.face_plane, opposite_);
}

// Of zones, given by all of their faces, ascending, the pieces beside the largest become zones of their own.
void Zones::separate(const std::vector<FaceId>& faces, std::vector<FaceId>& relabelled)
{
    for (std::uint32_t i = 0; i < faces.size(); ++i)
        index_[faces[i]] = i;
    UnionFind pieces(faces.size());
    for (std::uint32_t i = 0; i < faces.size(); ++i)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t o = opposite_[3 * faces[i] + k];
            if (!is_half_edge(o) || o / 3 > faces[i] || mesh_.face_plane[o / 3] != mesh_.face_plane[faces[i]]) continue;
            const std::uint32_t a = pieces.find(i), b = pieces.find(index_[o / 3]);
            if (a != b) pieces.join(std::min(a, b), std::max(a, b));
        }
    std::vector<std::uint32_t> size(faces.size(), 0); // of a piece, at its root
    for (std::uint32_t i = 0; i < faces.size(); ++i)
        ++size[pieces.find(i)];
    std::vector<std::uint32_t> largest(this->size(), kNone); // root
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
        std::uint32_t& root = largest[mesh_.face_plane[faces[i]]];
        if (size[i] > 0 && (root == kNone || size[i] > size[root])) root = i;
    }
    std::vector<PlaneId> zone(faces.size(), kNoPlane); // of a piece that is taken out, at its root
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
        PlaneId& here = mesh_.face_plane[faces[i]];
        const std::uint32_t root = pieces.find(i);
        if (i == root && root != largest[here]) zone[i] = add_zone(here);
        if (zone[root] == kNoPlane) continue;
        here = zone[root];
        relabelled.push_back(faces[i]);
    }
}

// Faces that were relabelled were inside their zones or on borders that stay borders.
void Zones::add_borders(const std::vector<FaceId>& relabelled)
{
    std::vector<std::uint32_t> added;
    for (const FaceId f : relabelled)
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
            const std::uint32_t o = opposite_[h];
            if (is_half_edge(o) && mesh_.face_plane[o / 3] != mesh_.face_plane[f]) added.push_back(std::min(h, o));
        }
    std::sort(added.begin(), added.end());
    std::vector<std::uint32_t> all;
    all.reserve(border_.size() + added.size());
    std::set_union(border_.begin(), border_.end(), added.begin(), std::unique(added.begin(), added.end()),
                   std::back_inserter(all));
    border_ = std::move(all);
    classify_ends(added);
}

// Finds the classes of the vertices of these half-edges anew.
void Zones::classify_ends(const std::vector<std::uint32_t>& border)
{
    std::vector<VertexId> vertex;
    for (const std::uint32_t h : border)
        for (const VertexId v : ends(h))
            vertex.push_back(v);
    std::sort(vertex.begin(), vertex.end());
    vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
    std::vector<std::uint8_t> touched(mesh_.mesh.position.size(), 0);
    for (const VertexId v : vertex)
        touched[v] = 1;
    std::vector<BorderUse> use(vertex.size());
    for (const std::uint32_t h : border_)
        for (const VertexId v : ends(h)) {
            if (touched[v] == 0) continue;
            const auto at = std::lower_bound(vertex.begin(), vertex.end(), v) - vertex.begin();
            const std::uint32_t o = opposite_[h];
            use[static_cast<std::size_t>(at)].add_edge(mesh_.face_plane[h / 3],
                                                       o == kBorderEdge ? kNoPlane : mesh_.face_plane[o / 3]);
        }
    for (std::size_t i = 0; i < vertex.size(); ++i)
        mesh_.vertex_class[vertex[i]] = use[i].vertex_class();
}

std::size_t Zones::rough_count() const
{
    return static_cast<std::size_t>(std::count(rough_.begin(), rough_.end(), std::uint8_t{1}));
}

ZonePart Zones::part() const
{
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
    for (FaceId f = 0; f < mesh_.face_plane.size(); ++f) {
        const PlaneId zone = mesh_.face_plane[f];
        if (!pending(zone) || !rough(zone)) continue;
        part.mesh.mesh.face.push_back(mesh_.mesh.face[f]);
        part.mesh.face_plane.push_back(zone);
        part.dense.insert(part.dense.end(), mesh_.mesh.face[f].begin(), mesh_.mesh.face[f].end());
    }
    std::sort(part.dense.begin(), part.dense.end());
    part.dense.erase(std::unique(part.dense.begin(), part.dense.end()), part.dense.end());
    const auto rename = [&](VertexId& v) {
        v = static_cast<VertexId>(std::lower_bound(part.dense.begin(), part.dense.end(), v) - part.dense.begin());
    };
    std::for_each(part.curves.vertex.begin(), part.curves.vertex.end(), rename);
    for (auto& face : part.mesh.mesh.face)
        std::for_each(face.begin(), face.end(), rename);
    for (const VertexId v : part.dense) {
        part.mesh.mesh.position.push_back(mesh_.mesh.position[v]);
        part.mesh.vertex_class.push_back(mesh_.vertex_class[v]);
    }
    return part;
}

std::vector<Zones::Cut> Zones::plan(const std::vector<Failure>& failures, const SimplifyParams& params)
{
    std::vector<Cut> cuts;
    std::vector<std::uint32_t> cut_of(size(), kNone);
    for (const Failure& failure : failures) {
        cut_of[failure.zone] = static_cast<std::uint32_t>(cuts.size());
        const std::uint8_t times = failed_[failure.zone]++;
        const double reach =
            times < kMostCuts ? std::ldexp(kFirstReach * params.max_error, std::min<int>(times, kMostDoublings)) : 0.0;
        cuts.push_back({&failure, reach, {}, {}});
    }
    for (FaceId f = 0; f < mesh_.face_plane.size(); ++f) {
        const PlaneId zone = mesh_.face_plane[f];
        if (cut_of[zone] == kNone) continue;
        Cut& cut = cuts[cut_of[zone]];
        cut.all.push_back(f);
    }
    parallel_for(cuts.size(), [&](std::size_t i) {
        Cut& cut = cuts[i];
        if (!(cut.reach > 0.0) || cut.failure->knot.empty()) return;
        const Surroundings near(mesh_.plane[cut.failure->zone], cut.failure->knot, cut.reach);
        std::ranges::copy_if(cut.all, std::back_inserter(cut.face), [&](FaceId f) { return near.has(mesh_.mesh, f); });
    });
    return cuts;
}

void Zones::cut(const std::vector<Failure>& failures, const SimplifyParams& params)
{
    pending_.assign(size(), 0);
    std::vector<FaceId> changed, relabelled;
    for (Cut& cut : plan(failures, params)) {
        const PlaneId zone = cut.failure->zone;
        pending_[zone] = 1;
        if (cut.face.empty() || kMostOfZone * cut.face.size() > cut.all.size()) {
            rough_[zone] = 1;
            continue;
        }
        const PlaneId knots = add_zone(zone);
        rough_[knots] = 1;
        for (const FaceId f : cut.face)
            mesh_.face_plane[f] = knots;
        std::ranges::set_difference(cut.all, cut.face, std::back_inserter(changed));
        relabelled.insert(relabelled.end(), cut.face.begin(), cut.face.end());
    }
    std::sort(changed.begin(), changed.end());
    separate(changed, relabelled);
    add_borders(relabelled);
    spread_pending();
}

// Calls visit(h, zone) for the zones on both sides of every border.
template <class Visit>
void Zones::for_each_side(const Visit& visit) const
{
    for (const std::uint32_t h : border_) {
        visit(h, mesh_.face_plane[h / 3]);
        if (opposite_[h] != kBorderEdge) visit(h, mesh_.face_plane[opposite_[h] / 3]);
    }
}

// On to the zones that rough ones touch, if only in a point: these do not keep to borders that are settled.
void Zones::spread_pending()
{
    std::vector<std::uint8_t> stirred(mesh_.mesh.position.size(), 0); // vertices of pending rough zones
    for (bool changed = true; changed;) {
        changed = false;
        for_each_side([&](std::uint32_t h, PlaneId zone) {
            if (!pending(zone) || !rough(zone)) return;
            for (const VertexId v : ends(h))
                changed = std::exchange(stirred[v], std::uint8_t{1}) == 0 || changed;
        });
        for_each_side([&](std::uint32_t h, PlaneId zone) {
            for (const VertexId v : ends(h))
                if (stirred[v]) pending_[zone] = 1;
        });
    }
}

PlaneId Zones::add_zone(PlaneId from)
{
    mesh_.plane.push_back(mesh_.plane[from]);
    mesh_.moments.push_back(mesh_.moments[from]);
    plane_of_.push_back(plane_of_[from]);
    failed_.push_back(failed_[from]);
    rough_.push_back(0);
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
