#include "simplify/zones.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>
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
    double reach = 0.0;   // [m]; 0: it has failed too often
    std::size_t size = 0; // faces of the zone
    std::vector<FaceId> face;

    bool takes(const TriangleMesh& mesh, const Plane& plane, FaceId f) const
    {
        for (int k = 0; k < 3; ++k)
            for (const Eigen::Vector3d& knot : failure->knot) {
                const Eigen::Vector3d offset = corner(mesh, f, k) - knot;
                if ((offset - plane.normal.dot(offset) * plane.normal).squaredNorm() <= reach * reach) return true;
            }
        return false;
    }
};

Zones::Zones(PlaneMesh mesh)
    : mesh_(std::move(mesh)), opposite_(opposite_half_edges(mesh_.mesh)), plane_of_(mesh_.plane.size()),
      failed_(mesh_.plane.size(), 0), rough_(mesh_.plane.size(), 0), pending_(mesh_.plane.size(), 1)
{
    std::iota(plane_of_.begin(), plane_of_.end(), 0u);
    separate(std::vector<std::uint8_t>(size(), 1));
    find_borders();
}

void Zones::find_borders()
{
    border_ = border_half_edges(mesh_, opposite_);
    mesh_.vertex_class = classify_vertices(mesh_.mesh, mesh_.face_plane, opposite_);
}

// Of the given zones, one flag a zone, the pieces beside the largest become zones of their own.
void Zones::separate(const std::vector<std::uint8_t>& zones)
{
    const std::vector<PlaneId> zone_of = mesh_.face_plane;
    UnionFind pieces(zone_of.size());
    for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
        const std::uint32_t o = opposite_[h];
        if (o == kNonManifoldEdge || o == kBorderEdge || o < h) continue;
        if (zones[zone_of[h / 3]] == 0 || zone_of[h / 3] != zone_of[o / 3]) continue;
        const std::uint32_t a = pieces.find(h / 3), b = pieces.find(o / 3);
        if (a != b) pieces.join(std::min(a, b), std::max(a, b));
    }
    std::vector<std::uint32_t> size(zone_of.size(), 0); // of a piece, at its root
    for (FaceId f = 0; f < zone_of.size(); ++f)
        if (zones[zone_of[f]] != 0) ++size[pieces.find(f)];
    std::vector<FaceId> largest(zones.size(), kNone); // root
    for (FaceId f = 0; f < zone_of.size(); ++f) {
        if (size[f] == 0) continue;
        FaceId& root = largest[zone_of[f]];
        if (root == kNone || size[f] > size[root]) root = f;
    }
    for (FaceId f = 0; f < zone_of.size(); ++f) {
        if (zones[zone_of[f]] == 0) continue;
        const FaceId root = pieces.find(f);
        if (root == largest[zone_of[f]]) continue;
        mesh_.face_plane[f] = f == root ? add_zone(zone_of[f]) : mesh_.face_plane[root];
    }
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
        cuts.push_back({&failure, reach, 0, {}});
    }
    for (FaceId f = 0; f < mesh_.face_plane.size(); ++f) {
        const PlaneId zone = mesh_.face_plane[f];
        if (cut_of[zone] == kNone) continue;
        Cut& cut = cuts[cut_of[zone]];
        ++cut.size;
        if (cut.reach > 0.0 && cut.takes(mesh_.mesh, mesh_.plane[zone], f)) cut.face.push_back(f);
    }
    return cuts;
}

void Zones::cut(const std::vector<Failure>& failures, const SimplifyParams& params)
{
    pending_.assign(size(), 0);
    std::vector<std::uint8_t> changed(size(), 0);
    for (const Cut& cut : plan(failures, params)) {
        const PlaneId zone = cut.failure->zone;
        pending_[zone] = 1;
        if (cut.face.empty() || kMostOfZone * cut.face.size() > cut.size) {
            rough_[zone] = 1;
            continue;
        }
        changed[zone] = 1;
        const PlaneId knots = add_zone(zone);
        rough_[knots] = 1;
        for (const FaceId f : cut.face)
            mesh_.face_plane[f] = knots;
    }
    changed.resize(size(), 0);
    separate(changed);
    find_borders();
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
    const auto ends = [&](std::uint32_t h) {
        return std::array{mesh_.mesh.face[h / 3][h % 3], mesh_.mesh.face[h / 3][(h % 3 + 1) % 3]};
    };
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
    mesh_.plane.push_back(Plane(mesh_.plane[from]));
    mesh_.moments.push_back(Moments(mesh_.moments[from]));
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
