#include "simplify/zones.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
      failed_(mesh_.plane.size(), 0), rough_(mesh_.plane.size(), 0)
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

PlaneMesh Zones::rough_part(const std::vector<std::uint8_t>& flat, Curves& curves) const
{
    PlaneMesh part;
    part.plane = mesh_.plane;
    part.moments = mesh_.moments;
    std::vector<VertexId> kept = curves.vertex;
    for (FaceId f = 0; f < mesh_.face_plane.size(); ++f) {
        if (flat[mesh_.face_plane[f]]) continue;
        part.mesh.face.push_back(mesh_.mesh.face[f]);
        part.face_plane.push_back(mesh_.face_plane[f]);
        kept.insert(kept.end(), mesh_.mesh.face[f].begin(), mesh_.mesh.face[f].end());
    }
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    const auto rename = [&](VertexId& v) {
        v = static_cast<VertexId>(std::lower_bound(kept.begin(), kept.end(), v) - kept.begin());
    };
    std::for_each(curves.vertex.begin(), curves.vertex.end(), rename);
    for (auto& face : part.mesh.face)
        std::for_each(face.begin(), face.end(), rename);
    for (const VertexId v : kept) {
        part.mesh.position.push_back(mesh_.mesh.position[v]);
        if (!mesh_.mesh.color.empty()) part.mesh.color.push_back(mesh_.mesh.color[v]);
        part.vertex_class.push_back(mesh_.vertex_class[v]);
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
    std::vector<std::uint8_t> changed(size(), 0);
    for (const Cut& cut : plan(failures, params)) {
        const PlaneId zone = cut.failure->zone;
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
}

PlaneId Zones::add_zone(PlaneId from)
{
    mesh_.plane.push_back(Plane(mesh_.plane[from]));
    mesh_.moments.push_back(Moments(mesh_.moments[from]));
    plane_of_.push_back(plane_of_[from]);
    failed_.push_back(failed_[from]);
    rough_.push_back(0);
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
