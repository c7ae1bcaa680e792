#include "simplify/remesher.h"

#include "base/parallel.h"
#include "simplify/collapse_mesh.h"
#include "simplify/knots.h"
#include "simplify/snap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

// What becomes of the errors [times those of the parameters] of borders that cross, step by step. Small errors keep
// close to the dense border, which crosses, or lies on one line, where it was moved onto planes: from kReleased on it
// is put back. What crosses even then is a knot of the dense border itself, to be jumped over.
constexpr std::array<float, 6> kTolerances{1.0f, 0.4f, 0.15f, 0.05f, 0.0f, 4.0f};
constexpr std::uint8_t kReleased = 3;
constexpr std::size_t kPlaneGrain = 2; // [planes]

// Of curves that do not move: what they lie at, settled zones or faces of the dense mesh.
constexpr std::uint8_t kSettled = 1, kDense = 2;

} // namespace

Remesher::Remesher(const Zones& zones, ZonePart part, const Settled& settled, const SimplifyParams& params)
    : part_(std::move(part)), params_(params), flat_(zones.size(), 0), curves_(part_.curves),
      fixed_(curves_.curve.size(), 0), held_(part_.dense.size(), 0), filled_(curves_.curve.size(), 0),
      faces_(zones.size())
{
    for (PlaneId z = 0; z < flat_.size(); ++z)
        flat_[z] = zones.pending(z) && !zones.rough(z) ? 1 : 0;
    for (CurveId id = 0; id < fixed_.size(); ++id)
        for (const PlaneId z : curves_.curve[id].planes) {
            if (z == kNoPlane || flat_[z]) continue;
            fixed_[id] = zones.rough(z) ? kDense : kSettled;
            if (zones.rough(z)) break;
        }
    hold_settled(settled);
    straighten(settled);
}

bool Remesher::run()
{
    fill_holes();
    thin_free_curves();
    triangulate_planes();
    return std::none_of(failed_.begin(), failed_.end(), [](std::uint8_t f) { return f != 0; });
}

// Vertices and edges of the settled zones that those to be simplified may have, too.
void Remesher::hold_settled(const Settled& settled)
{
    const auto index = [&](VertexId v) { return std::lower_bound(part_.dense.begin(), part_.dense.end(), v); };
    const auto is_here = [&](auto at, VertexId v) { return at != part_.dense.end() && *at == v; };
    for (const auto& faces : settled.face)
        for (const Face& face : faces)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto a = index(face[k]), b = index(face[(k + 1) % 3]);
                if (!is_here(a, face[k])) continue;
                held_[static_cast<std::size_t>(a - part_.dense.begin())] = 1;
                if (!is_here(b, face[(k + 1) % 3])) continue;
                const auto [low, high] = std::minmax({a - part_.dense.begin(), b - part_.dense.begin()}); // by value
                settled_edges_.push_back({static_cast<VertexId>(low), static_cast<VertexId>(high)});
            }
}

// Vertices of curves onto the planes they bound, but for those of faces that stay.
void Remesher::straighten(const Settled& settled)
{
    PlaneMesh straight = part_.mesh;
    snap_curves(curves_, straight, params_);
    auto& position = straight.mesh.position;
    for (std::uint32_t s = 0; s < curves_.size(); ++s)
        if (fixed_[curves_.curve_of[s]] == kDense)
            position[curves_.vertex[s]] = part_.mesh.mesh.position[curves_.vertex[s]];
    for (VertexId v = 0; v < held_.size(); ++v)
        if (held_[v]) position[v] = settled.position[part_.dense[v]];
    for (std::uint32_t s = 0; s < curves_.size(); ++s)
        curves_.point[s] = position[curves_.vertex[s]].cast<double>();
    position_ = doubles(position);
    for (CurveId id = 0; id < fixed_.size(); ++id)
        if (fixed_[id] == kSettled) take_over(curves_.curve[id], settled);
}

// Leaves the vertices of the curve that a settled zone has left.
void Remesher::take_over(Curve& curve, const Settled& settled)
{
    const auto gone = [&](std::uint32_t s) { return settled.gone[part_.dense[curves_.vertex[s]]] != 0; };
    std::vector<std::uint32_t> left;
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s) {
        curves_.next[s] = curves_.previous[s] = Curves::kNone;
        if (!gone(s)) left.push_back(s);
    }
    curve.head = left.front();
    for (std::size_t i = 0; i + 1 < left.size(); ++i) {
        curves_.next[left[i]] = left[i + 1];
        curves_.previous[left[i + 1]] = left[i];
    }
    if (!curve.closed) return;
    curves_.next[left.back()] = left.front();
    curves_.previous[left.front()] = left.back();
}

// Does the curve lie around a hole of the mesh inside a plane? Seen from where the normal points it runs clockwise.
bool Remesher::is_hole(CurveId id) const
{
    const Curve& curve = curves_.curve[id];
    if (!curve.closed || curve.planes[1] != kNoPlane || fixed_[id]) return false;
    const Eigen::Vector3d origin = curves_.point[curve.first];
    double turn = 0.0; // twice the signed area, walking as the half-edges of the plane do
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s) {
        const Eigen::Vector3d a = curves_.point[s] - origin, b = curves_.point[curves_.after(curve, s)] - origin;
        turn += curve.runs[0] * part_.mesh.plane[curve.planes[0]].normal.dot(a.cross(b));
    }
    return turn < 0.0;
}

// Filling a hole that lies within the error of its middle moves the border of the mesh by no more than the error.
bool Remesher::is_small_hole(CurveId id) const
{
    if (!is_hole(id)) return false;
    const Curve& curve = curves_.curve[id];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s)
        middle += curves_.point[s] / curve.count;
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s)
        if ((curves_.point[s] - middle).norm() > params_.max_open_error) return false;
    return true;
}

void Remesher::fill_holes()
{
    for (CurveId id = 0; id < filled_.size(); ++id)
        filled_[id] = is_small_hole(id) ? 1 : 0;
}

// Edges of faces that stay, ascending.
Remesher::Edges Remesher::taken_edges() const
{
    Edges edges = settled_edges_;
    edges.insert(edges.end(), part_.rough_edge.begin(), part_.rough_edge.end());
    std::sort(edges.begin(), edges.end());
    return edges;
}

void Remesher::bound_free_curves()
{
    bounds_.tolerance.assign(curves_.size(), kTolerances[0]);
    step_.assign(curves_.size(), 0);
    released_.assign(part_.mesh.mesh.position.size(), 0);
    for (std::uint32_t s = 0; s < curves_.size(); ++s) {
        const VertexId v = curves_.vertex[s];
        if (part_.mesh.vertex_class[v] == VertexClass::Corner) corner_slots_.emplace_back(v, s);
        if (held_[v] || fixed_[curves_.curve_of[s]]) released_[v] = 1; // faces hold it where it is
    }
    std::sort(corner_slots_.begin(), corner_slots_.end());
    bound_edges();
}

double Remesher::length(const Curve& curve) const
{
    double sum = 0.0;
    for (std::uint32_t i = 0, s = curve.first; i < curves_.edges(curve); ++i, s = curves_.after(curve, s))
        sum += (curves_.point[curves_.after(curve, s)] - curves_.point[s]).norm();
    return sum;
}

// Of curves between the same corners one alone, the shortest, may become a single edge.
void Remesher::bound_edges()
{
    struct Ends {
        std::array<VertexId, 2> vertex{};
        double length = 0.0;
        CurveId id = 0;
        auto operator<=>(const Ends&) const = default;
    };
    bounds_.least_edges.assign(curves_.curve.size(), 3);
    const auto taken = taken_edges();
    std::vector<Ends> ends;
    for (CurveId id = 0; id < curves_.curve.size(); ++id) {
        const Curve& curve = curves_.curve[id];
        const auto [low, high] =
            std::minmax(curves_.vertex[curve.first], curves_.vertex[curve.first + curve.count - 1]);
        if (!curve.closed && low != high) ends.push_back({{low, high}, length(curve), id});
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const bool twin = i > 0 && ends[i].vertex == ends[i - 1].vertex;
        const bool edge = std::binary_search(taken.begin(), taken.end(), ends[i].vertex);
        bounds_.least_edges[ends[i].id] = twin || edge ? 2 : 1;
    }
}

void Remesher::thin_free_curves()
{
    for (CurveId id = 0; id < curves_.curve.size(); ++id)
        if (!fixed_[id] && !filled_[id]) free_.push_back(id);
    bound_free_curves();
    const Outlines outlines(part_.mesh, curves_, filled_);
    dirty_.assign(curves_.curve.size(), 0);
    std::vector<CurveId> again = free_;
    CurveThinner thinner(part_.mesh, curves_, position_, params_);
    Flags changed(flat_.size(), 1);
    do {
        thinner.thin(again, bounds_);
        if (!tighten(outlines, changed)) return;
        again.clear();
        for (const CurveId id : free_)
            if (dirty_[id]) again.push_back(id);
        changed.assign(changed.size(), 0);
        for (const CurveId id : again) {
            restore(id);
            for (const PlaneId p : curves_.curve[id].planes)
                if (p != kNoPlane) changed[p] = 1;
        }
    } while (!again.empty());
}

void Remesher::restore(CurveId id)
{
    dirty_[id] = 0;
    Curve& curve = curves_.curve[id];
    curves_.restore(curve);
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s)
        position_[curves_.vertex[s]] = curves_.point[s];
}

// Borders that cross or, where none do, contradict each other or, where they agree, leave no room for a face.
std::vector<Remesher::BadSegment> Remesher::bad_segments(const PlaneOutline& plane) const
{
    std::vector<BadSegment> bad;
    for (const auto& pair : crossings(plane.outline))
        for (const std::uint32_t i : pair)
            bad.push_back({plane.source[i]});
    if (!bad.empty()) return bad;
    const auto faces = triangulate(plane.outline);
    if (!faces)
        for (const std::uint32_t i : contradictions(plane.outline))
            bad.push_back({plane.source[i]});
    else // only what moved the border onto one line takes the room
        for (const std::uint32_t i : segments_without_room(plane, position_, *faces))
            bad.push_back({plane.source[i], kReleased});
    return bad;
}

// Takes the next step where borders of changed planes are bad. Is there one?
bool Remesher::tighten(const Outlines& outlines, const Flags& changed)
{
    std::vector<std::vector<BadSegment>> bad(flat_.size());
    parallel_for(
        flat_.size(),
        [&](std::size_t p) {
            if (!flat_[p] || !changed[p]) return;
            const PlaneOutline plane = outlines.of(static_cast<PlaneId>(p), position_);
            bad[p] = bad_segments(plane);
        },
        kPlaneGrain);
    for (const auto& segments : bad)
        for (const auto& segment : segments)
            tighten_segment(segment);
    return std::count(dirty_.begin(), dirty_.end(), 1) > 0;
}

void Remesher::tighten_segment(const BadSegment& bad)
{
    const auto& [source, least_step] = bad;
    const Curve& curve = curves_.curve[source.curve];
    if (fixed_[source.curve] || filled_[source.curve]) return;
    if (step_[source.from] + 1u == kTolerances.size() && is_hole(source.curve)) {
        filled_[source.curve] = dirty_[source.curve] = 1; // a hole that leaves no room beside it for a border
        return;
    }
    for (std::uint32_t s = source.from;; s = curves_.after(curve, s)) {
        if (step_[s] + 1u < kTolerances.size()) {
            const auto next = std::max<std::uint8_t>(least_step, step_[s] + 1);
            if (step_[s] < kReleased && next >= kReleased) release(s);
            bounds_.tolerance[s] = kTolerances[step_[s] = next];
            dirty_[source.curve] = 1;
        }
        if (s == source.to) return;
    }
}

// Puts a vertex back where the dense mesh has it, in all curves that it belongs to.
void Remesher::release(std::uint32_t slot)
{
    const VertexId v = curves_.vertex[slot];
    if (released_[v]) return;
    released_[v] = 1;
    const auto put_back = [&](std::uint32_t s) {
        curves_.point[s] = part_.mesh.mesh.position[v].cast<double>();
        dirty_[curves_.curve_of[s]] = 1;
    };
    if (part_.mesh.vertex_class[v] != VertexClass::Corner) return put_back(slot);
    auto at = std::lower_bound(corner_slots_.begin(), corner_slots_.end(), std::pair(v, 0u));
    for (; at != corner_slots_.end() && at->first == v; ++at)
        put_back(at->second);
}

void Remesher::triangulate_planes()
{
    const Outlines outlines(part_.mesh, curves_, filled_);
    for (auto& p : position_)
        p = p.cast<float>().cast<double>(); // as they are written
    failed_.assign(flat_.size(), 0);
    knots_.assign(flat_.size(), {});
    parallel_for(
        flat_.size(),
        [&](std::size_t p) {
            if (flat_[p]) triangulate_plane(outlines, static_cast<PlaneId>(p));
        },
        kPlaneGrain);
}

void Remesher::triangulate_plane(const Outlines& outlines, PlaneId p)
{
    failed_[p] = 1;
    if (outlines.curves_of(p).empty()) return; // a closed surface
    const PlaneOutline plane = outlines.of(p, position_);
    const auto faces = triangulate(plane.outline);
    auto spoilt = faces ? segments_aside(plane.outline, *faces) : std::vector<std::uint32_t>();
    if (faces && spoilt.empty()) spoilt = segments_without_room(plane, position_, *faces);
    if (!faces || faces->empty() || !spoilt.empty()) {
        knots_[p] = find_knots(plane, position_, spoilt);
        return;
    }
    failed_[p] = 0;
    for (const auto& [a, b, c] : *faces)
        faces_[p].push_back({plane.vertex[a], plane.vertex[b], plane.vertex[c]});
}

std::vector<Zones::Failure> Remesher::failures() const
{
    std::vector<Zones::Failure> failures;
    for (PlaneId p = 0; p < failed_.size(); ++p)
        if (failed_[p]) failures.push_back({p, knots_[p]});
    return failures;
}

void Remesher::settle(Settled& settled) const
{
    settled.face.resize(flat_.size());
    const auto dense = [&](const Face& face) {
        return Face{part_.dense[face[0]], part_.dense[face[1]], part_.dense[face[2]]};
    };
    for (PlaneId p = 0; p < faces_.size(); ++p)
        for (const Face& face : faces_[p])
            settled.face[p].push_back(dense(face));
    for (VertexId v = 0; v < position_.size(); ++v)
        settled.position[part_.dense[v]] = position_[v].cast<float>();
    for (std::uint32_t s = 0; s < curves_.size(); ++s)
        settled.gone[part_.dense[curves_.vertex[s]]] = curves_.left(s) ? 0 : 1;
}

} // namespace quoin
