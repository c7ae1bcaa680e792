// Taking knots out of zones.
#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "simplify/cut_off.h"
#include "simplify/surroundings.h"
#include "simplify/zones.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace quoin {
namespace {

constexpr std::uint8_t kMostCuts = 24; // of a zone
constexpr double kFirstReach = 1.5;    // around a knot, in errors of borders
constexpr int kMostDoublings = 2;      // of the reach, one with every cut that did not go far enough
constexpr std::size_t kMostOfZone = 2; // a cut takes less than one in so many of a zone's faces
constexpr std::uint32_t kNoCut = 0xffffffffu;
constexpr std::size_t kBorderGrain = 1 << 14; // [half-edges]

} // namespace

// What one failure takes out of its zone.
struct Zones::Cut {
    const Failure* failure = nullptr;
    std::vector<std::uint32_t> border;        // half-edges of the zone
    std::vector<FaceId> face;                 // those to take out, ascending; none: all
    std::vector<std::vector<FaceId>> cut_off; // what comes off with them
};

// Half-edges of the zones that have failed, on their own side.
std::vector<Zones::Cut> Zones::begin_cuts(const std::vector<Failure>& failures) const
{
    std::vector<Cut> cuts(failures.size());
    std::vector<std::uint32_t> cut_of(size(), kNoCut);
    for (std::uint32_t i = 0; i < cuts.size(); ++i) {
        cuts[i].failure = &failures[i];
        cut_of[failures[i].zone] = i;
    }
    const auto cut_at = [&](std::uint32_t h) { return h == kBorderEdge ? kNoCut : cut_of[mesh_.face_plane[h / 3]]; };
    const auto at_cuts = parallel_select<std::uint32_t>(border_.size(), kBorderGrain, [&](std::size_t i) {
        return cut_at(border_[i]) != kNoCut || cut_at(opposite_[border_[i]]) != kNoCut;
    });
    for (const std::uint32_t b : at_cuts)
        for (const std::uint32_t h : {border_[b], opposite_[border_[b]]})
            if (const std::uint32_t i = cut_at(h); i != kNoCut) cuts[i].border.push_back(h);
    return cuts;
}

// Knots at what was cut out before, where it was not enough; then the others.
std::array<std::vector<Eigen::Vector3d>, 2> Zones::sort_knots(const Cut& cut, double reach) const
{
    const PlaneId zone = cut.failure->zone;
    std::vector<std::uint8_t> again(cut.failure->knot.size(), 0);
    const Surroundings near(mesh_.plane[zone], cut.failure->knot, reach);
    for (const std::uint32_t h : cut.border) {
        const std::uint32_t o = opposite_[h];
        if (o == kBorderEdge) continue;
        const PlaneId other = mesh_.face_plane[o / 3];
        if (!rough(other) || plane_of_[other] != plane_of_[zone]) continue;
        for (const VertexId v : ends(h))
            near.for_each(mesh_.mesh.position[v].cast<double>(), [&](std::uint32_t i) { again[i] = 1; });
    }
    std::array<std::vector<Eigen::Vector3d>, 2> sorted;
    for (std::size_t i = 0; i < again.size(); ++i)
        sorted[again[i] ? 0 : 1].push_back(cut.failure->knot[i]);
    return sorted;
}

// The faces of the zone around the knots that hang together with its border there.
void Zones::find_faces(Cut& cut, double reach, const std::vector<Eigen::Vector3d>& knots)
{
    if (knots.empty()) return;
    const PlaneId zone = cut.failure->zone;
    const Surroundings near(mesh_.plane[zone], knots, reach);
    const std::size_t first = cut.face.size();
    const auto take = [&](FaceId f) {
        if (mark_[f] != 0 || mesh_.face_plane[f] != zone || !near.has(mesh_.mesh, f)) return;
        mark_[f] = 1;
        cut.face.push_back(f);
    };
    for (const std::uint32_t h : cut.border)
        take(h / 3);
    for (std::size_t i = first; i < cut.face.size(); ++i)
        for (std::uint32_t k = 0; k < 3; ++k)
            if (const std::uint32_t o = opposite_[3 * cut.face[i] + k]; is_half_edge(o)) take(o / 3);
}

void Zones::find_faces(Cut& cut, const SimplifyParams& params)
{
    const PlaneId zone = cut.failure->zone;
    const std::uint8_t times = failed_[zone];
    if (times >= kMostCuts || cut.failure->knot.empty()) return;
    const double reach = kFirstReach * params.max_error,
                 farther = std::ldexp(reach, std::min<int>(times, kMostDoublings));
    const auto [again, fresh] = sort_knots(cut, reach);
    find_faces(cut, farther, again);
    find_faces(cut, reach, fresh);
    for (const FaceId f : cut.face)
        mark_[f] = 0;
    if (kMostOfZone * cut.face.size() > faces_[zone]) cut.face.clear();
    std::ranges::sort(cut.face);
}

// Gives the faces to a zone of their own.
PlaneId Zones::take_out(const std::vector<FaceId>& faces)
{
    const PlaneId from = mesh_.face_plane[faces.front()], zone = add_zone(from);
    for (const FaceId f : faces)
        mesh_.face_plane[f] = zone;
    faces_[from] -= static_cast<FaceId>(faces.size());
    faces_[zone] = static_cast<FaceId>(faces.size());
    return zone;
}

void Zones::find_cut_off(Cut& cut)
{
    std::vector<FaceId> beside;
    for (const FaceId f : cut.face)
        for (std::uint32_t k = 0; k < 3; ++k)
            if (const std::uint32_t o = opposite_[3 * f + k];
                is_half_edge(o) && mesh_.face_plane[o / 3] == cut.failure->zone)
                beside.push_back(o / 3);
    cut.cut_off = cut_off_pieces(mesh_.face_plane, opposite_, beside, mark_);
}

// Gives the faces to a rough zone, or all of the zone up. Marks the vertices of what becomes rough.
void Zones::take_out(const Cut& cut, std::vector<std::uint8_t>& stirred)
{
    const PlaneId zone = cut.failure->zone;
    const bool whole = cut.face.empty();
    const PlaneId knots = whole ? zone : take_out(cut.face);
    ++failed_[zone];
    pending_[zone] = 1;
    rough_[knots] = 1;
    noted_[knots] = whole ? 0 : 1;
    pending_[knots] = 0;
    for (const FaceId f : cut.face)
        for (const VertexId v : mesh_.mesh.face[f])
            stirred[v] = 1;
    for (const std::uint32_t h : cut.border)
        for (const VertexId v : ends(h))
            if (whole) stirred[v] = 1;
}

void Zones::cut(const std::vector<Failure>& failures, const SimplifyParams& params)
{
    pending_.assign(size(), 0);
    auto cuts = begin_cuts(failures);
    parallel_for(cuts.size(), [&](std::size_t i) { find_faces(cuts[i], params); });
    std::vector<std::uint8_t> stirred(mesh_.mesh.position.size(), 0);
    for (const Cut& cut : cuts)
        take_out(cut, stirred);
    parallel_for(cuts.size(), [&](std::size_t i) { find_cut_off(cuts[i]); });
    std::vector<FaceId> relabelled;
    for (const Cut& cut : cuts) {
        relabelled.insert(relabelled.end(), cut.face.begin(), cut.face.end());
        for (const auto& piece : cut.cut_off) {
            take_out(piece);
            relabelled.insert(relabelled.end(), piece.begin(), piece.end());
        }
    }
    add_borders(relabelled);
    for (const Cut& cut : cuts)
        for (const FaceId f : cut.face)
            note_edges(f);
    spread_pending(stirred);
}

// On to the flat zones that have a vertex of what was stirred.
void Zones::spread_pending(const std::vector<std::uint8_t>& stirred)
{
    const auto at_stirred = parallel_select<std::uint32_t>(border_.size(), kBorderGrain, [&](std::size_t i) {
        const auto [a, b] = ends(border_[i]);
        return stirred[a] || stirred[b];
    });
    for (const std::uint32_t i : at_stirred)
        for (const std::uint32_t h : {border_[i], opposite_[border_[i]]})
            if (h != kBorderEdge && !rough(mesh_.face_plane[h / 3])) pending_[mesh_.face_plane[h / 3]] = 1;
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
    const auto at_touched = parallel_select<std::uint32_t>(border_.size(), kBorderGrain, [&](std::size_t i) {
        const auto [a, b] = ends(border_[i]);
        return touched[a] || touched[b];
    });
    std::vector<BorderUse> use(vertex.size());
    for (const std::uint32_t i : at_touched)
        for (const VertexId v : ends(border_[i])) {
            if (touched[v] == 0) continue;
            const auto at = std::lower_bound(vertex.begin(), vertex.end(), v) - vertex.begin();
            const std::uint32_t h = border_[i], o = opposite_[h];
            use[static_cast<std::size_t>(at)].add_edge(mesh_.face_plane[h / 3],
                                                       o == kBorderEdge ? kNoPlane : mesh_.face_plane[o / 3]);
        }
    for (std::size_t i = 0; i < vertex.size(); ++i)
        mesh_.vertex_class[vertex[i]] = use[i].vertex_class();
}

} // namespace quoin
