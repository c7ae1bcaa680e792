#include "simplify/remesh.h"

#include "base/log.h"
#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "simplify/collapse_mesh.h"
#include "simplify/contract.h"
#include "simplify/outlines.h"
#include "simplify/snap.h"
#include "simplify/stitch.h"
#include "simplify/zones.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

// What becomes of the errors [times those of the parameters] of borders that cross, step by step. Small errors keep
// close to the dense border, which crosses where it was moved onto planes: from kReleased on it is put back. What
// crosses even then is a knot of the dense border itself, to be jumped over.
constexpr std::array<float, 6> kTolerances{1.0f, 0.4f, 0.15f, 0.05f, 0.0f, 4.0f};
constexpr std::uint8_t kReleased = 3;
constexpr std::size_t kPlaneGrain = 8; // [planes]

using Flags = std::vector<std::uint8_t>;

// The zones that can be filled anew between their borders.
Flags flat_zones(const Zones& zones, const Curves& curves, const SimplifyParams& params)
{
    Flags flat(zones.size(), 1);
    for (PlaneId z = 0; z < flat.size(); ++z) {
        const bool bent =
            params.max_inner_error > 0.0 && rms_to_plane(zones.moments(z), zones.plane(z)) > params.max_inner_error;
        if (zones.rough(z) || bent) flat[z] = 0;
    }
    for (const Curve& curve : curves.curve)
        for (std::size_t k = 0; k < 2; ++k)
            if (curve.planes[k] != kNoPlane && curve.runs[k] == 0) flat[curve.planes[k]] = 0;
    return flat;
}

// Of every face the piece that it belongs to.
std::vector<std::uint32_t> pieces_of(const std::vector<Face>& faces, std::size_t vertices)
{
    TriangleMesh mesh;
    mesh.position.resize(vertices);
    mesh.face = faces;
    return face_components(mesh);
}

// The segments around all pieces but the largest. Zones are one piece each; but what sticks out of one on a stalk, with
// a border of its own, is laid down beside it.
std::vector<std::uint32_t> segments_aside(const Outline& outline, const std::vector<Face>& faces)
{
    const auto piece = pieces_of(faces, outline.point.size());
    std::vector<std::size_t> size;
    for (const std::uint32_t p : piece) {
        size.resize(std::max<std::size_t>(size.size(), p + 1), 0);
        ++size[p];
    }
    const auto main = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<std::array<std::uint32_t, 2>> aside; // half-edges
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
            if (piece[f] != main) aside.push_back({faces[f][k], faces[f][(k + 1) % 3]});
    std::sort(aside.begin(), aside.end());
    std::vector<std::uint32_t> found;
    for (std::uint32_t s = 0; s < outline.segment.size(); ++s)
        if (std::binary_search(aside.begin(), aside.end(), outline.segment[s])) found.push_back(s);
    return found;
}

// One attempt to fill all flat planes, which are zones of those of the dense mesh; those that cannot be are reported as
// failed. `mesh` has the faces of the others.
class Remesher {
public:
    Remesher(const PlaneMesh& mesh, const Curves& traced, const Flags& flat, const SimplifyParams& params)
        : mesh_(mesh), params_(params), flat_(flat), curves_(traced), filled_(traced.curve.size(), 0), rough_(mesh),
          faces_(mesh.plane.size())
    {
    }

    bool run()
    {
        straighten();
        simplify_rough();
        fill_holes();
        thin_free_curves();
        triangulate_planes();
        return std::none_of(failed_.begin(), failed_.end(), [](std::uint8_t f) { return f != 0; });
    }
    std::vector<Zones::Failure> failures() const;
    PlaneMesh result() const;

private:
    void straighten();
    void simplify_rough();
    void fill_holes();
    bool is_small_hole(const Curve& curve) const;
    void bound_free_curves();
    void bound_edges();
    double length(const Curve& curve) const;
    void thin_free_curves();
    void restore(CurveId id);
    static std::vector<PlaneOutline::Source> bad_segments(const PlaneOutline& plane);
    std::vector<Eigen::Vector3d> knots(const PlaneOutline& plane, const std::vector<std::uint32_t>& aside) const;
    bool tighten(const Outlines& outlines, const Flags& changed);
    void tighten_segment(const PlaneOutline::Source& source);
    void release(std::uint32_t slot);
    void triangulate_planes();
    std::vector<std::array<VertexId, 2>> rough_corner_edges() const;

    const PlaneMesh& mesh_;
    const SimplifyParams& params_;
    const Flags& flat_;
    Curves curves_;
    Flags filled_; // one a curve: borders of holes that vanish
    PlaneMesh rough_;
    std::vector<Eigen::Vector3d> position_; // V
    CurveBounds bounds_;
    std::vector<std::uint8_t> step_;                               // one a slot, of kTolerances
    std::vector<CurveId> free_;                                    // curves with flat planes alone
    Flags dirty_;                                                  // one a curve: to be simplified again
    std::vector<std::pair<VertexId, std::uint32_t>> corner_slots_; // of all curves, sorted
    Flags released_;                                               // one a vertex: is where it was in the dense mesh
    std::vector<std::vector<Face>> faces_;                         // one per plane
    Flags failed_;                                                 // one per plane
    std::vector<std::vector<Eigen::Vector3d>> knots_;              // of planes that failed
};

// Vertices of curves onto the planes they bound; only rough planes have faces that could turn over.
void Remesher::straighten()
{
    snap_curves(curves_, rough_, params_);
    for (std::uint32_t s = 0; s < curves_.size(); ++s)
        curves_.point[s] = rough_.mesh.position[curves_.vertex[s]].cast<double>();
    for (Curve& curve : curves_.curve) {
        curve.in_mesh = false;
        for (const PlaneId p : curve.planes)
            if (p != kNoPlane && !flat_[p]) curve.in_mesh = true;
    }
}

void Remesher::simplify_rough()
{
    if (!rough_.mesh.face.empty()) contract(rough_, curves_, params_);
    position_ = doubles(rough_.mesh.position);
}

// Filling a hole that lies within the error of its middle moves the border of the mesh by no more than the error.
bool Remesher::is_small_hole(const Curve& curve) const
{
    if (!curve.closed || curve.planes[1] != kNoPlane || curve.in_mesh) return false;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s)
        middle += curves_.point[s] / curve.count;
    double turn = 0.0; // twice the signed area, walking as the half-edges of the plane do
    for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s) {
        const Eigen::Vector3d a = curves_.point[s] - middle, b = curves_.point[curves_.after(curve, s)] - middle;
        if (a.norm() > params_.max_open_error) return false;
        turn += curve.runs[0] * mesh_.plane[curve.planes[0]].normal.dot(a.cross(b));
    }
    return turn < 0.0;
}

void Remesher::fill_holes()
{
    for (CurveId id = 0; id < filled_.size(); ++id)
        filled_[id] = is_small_hole(curves_.curve[id]) ? 1 : 0;
}

// Edges that are left in rough planes between corners, ascending.
std::vector<std::array<VertexId, 2>> Remesher::rough_corner_edges() const
{
    std::vector<std::array<VertexId, 2>> edges;
    const auto corner = [&](VertexId v) { return mesh_.vertex_class[v] == VertexClass::Corner; };
    for (const auto& face : rough_.mesh.face)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(face[k], face[(k + 1) % 3]);
            if (corner(low) && corner(high)) edges.push_back({low, high});
        }
    std::sort(edges.begin(), edges.end());
    return edges;
}

void Remesher::bound_free_curves()
{
    bounds_.tolerance.assign(curves_.size(), kTolerances[0]);
    step_.assign(curves_.size(), 0);
    released_.assign(mesh_.mesh.position.size(), 0);
    for (std::uint32_t s = 0; s < curves_.size(); ++s) {
        const VertexId v = curves_.vertex[s];
        if (mesh_.vertex_class[v] == VertexClass::Corner) corner_slots_.emplace_back(v, s);
        if (curves_.curve[curves_.curve_of[s]].in_mesh) released_[v] = 1; // faces hold it where it is
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
    const auto taken = rough_corner_edges();
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
        if (!curves_.curve[id].in_mesh && !filled_[id]) free_.push_back(id);
    bound_free_curves();
    const Outlines outlines(mesh_, curves_, filled_);
    dirty_.assign(curves_.curve.size(), 0);
    std::vector<CurveId> again = free_;
    Flags changed(mesh_.plane.size(), 1);
    do {
        thin_curves(CurveFit(mesh_, curves_, position_, params_), again, bounds_, curves_, position_);
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

// Borders that cross or, where none do, contradict each other.
std::vector<PlaneOutline::Source> Remesher::bad_segments(const PlaneOutline& plane)
{
    std::vector<PlaneOutline::Source> bad;
    for (const auto& pair : crossings(plane.outline))
        for (const std::uint32_t i : pair)
            bad.push_back(plane.source[i]);
    if (!bad.empty()) return bad;
    for (const std::uint32_t i : contradictions(plane.outline))
        bad.push_back(plane.source[i]);
    return bad;
}

// Takes the next step where borders of changed planes are bad. Is there one?
bool Remesher::tighten(const Outlines& outlines, const Flags& changed)
{
    std::vector<std::vector<PlaneOutline::Source>> bad(mesh_.plane.size());
    parallel_for(
        mesh_.plane.size(),
        [&](std::size_t p) {
            if (!flat_[p] || !changed[p]) return;
            const PlaneOutline plane = outlines.of(static_cast<PlaneId>(p), position_);
            bad[p] = bad_segments(plane);
        },
        kPlaneGrain);
    for (const auto& sources : bad)
        for (const auto& source : sources)
            tighten_segment(source);
    return std::count(dirty_.begin(), dirty_.end(), 1) > 0;
}

void Remesher::tighten_segment(const PlaneOutline::Source& source)
{
    const Curve& curve = curves_.curve[source.curve];
    if (curve.in_mesh || filled_[source.curve]) return;
    if (curve.closed && curve.planes[1] == kNoPlane && step_[source.from] + 1u == kTolerances.size()) {
        filled_[source.curve] = dirty_[source.curve] = 1; // a hole that leaves no room beside it for a border
        return;
    }
    for (std::uint32_t s = source.from;; s = curves_.after(curve, s)) {
        if (step_[s] + 1u < kTolerances.size()) {
            bounds_.tolerance[s] = kTolerances[++step_[s]];
            if (step_[s] == kReleased) release(s);
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
        curves_.point[s] = mesh_.mesh.position[v].cast<double>();
        dirty_[curves_.curve_of[s]] = 1;
    };
    if (mesh_.vertex_class[v] != VertexClass::Corner) return put_back(slot);
    auto at = std::lower_bound(corner_slots_.begin(), corner_slots_.end(), std::pair(v, 0u));
    for (; at != corner_slots_.end() && at->first == v; ++at)
        put_back(at->second);
}

void Remesher::triangulate_planes()
{
    const Outlines outlines(mesh_, curves_, filled_);
    for (auto& p : position_)
        p = p.cast<float>().cast<double>(); // as they are written
    failed_.assign(mesh_.plane.size(), 0);
    knots_.assign(mesh_.plane.size(), {});
    parallel_for(
        mesh_.plane.size(),
        [&](std::size_t p) {
            if (!flat_[p] || outlines.curves_of(static_cast<PlaneId>(p)).empty()) {
                failed_[p] = flat_[p]; // a plane without a border is a closed surface
                return;
            }
            const PlaneOutline plane = outlines.of(static_cast<PlaneId>(p), position_);
            const auto faces = triangulate(plane.outline);
            const auto aside = faces ? segments_aside(plane.outline, *faces) : std::vector<std::uint32_t>();
            failed_[p] = faces && !faces->empty() && aside.empty() ? 0 : 1;
            if (failed_[p]) {
                knots_[p] = knots(plane, aside);
                return;
            }
            for (const auto& [a, b, c] : *faces)
                faces_[p].push_back({plane.vertex[a], plane.vertex[b], plane.vertex[c]});
        },
        kPlaneGrain);
}

// Where borders cross; or ends and middles of the segments that lie aside or contradict each other.
std::vector<Eigen::Vector3d> Remesher::knots(const PlaneOutline& plane, const std::vector<std::uint32_t>& aside) const
{
    std::vector<Eigen::Vector3d> knots;
    const auto on_segment = [&](std::uint32_t i, double t) {
        const auto [a, b] = plane.outline.segment[i];
        return Eigen::Vector3d((1.0 - t) * position_[plane.vertex[a]] + t * position_[plane.vertex[b]]);
    };
    for (const auto& [i, j] : crossings(plane.outline))
        knots.push_back(on_segment(i, crossing_parameter(plane.outline, i, j)));
    if (!knots.empty()) return knots;
    for (const std::uint32_t i : aside.empty() ? contradictions(plane.outline) : aside)
        for (const double t : {0.0, 0.5, 1.0})
            knots.push_back(on_segment(i, t));
    return knots;
}

std::vector<Zones::Failure> Remesher::failures() const
{
    std::vector<Zones::Failure> failures;
    for (PlaneId p = 0; p < failed_.size(); ++p)
        if (failed_[p]) failures.push_back({p, knots_[p]});
    return failures;
}

PlaneMesh Remesher::result() const
{
    PlaneMesh out;
    out.plane = mesh_.plane;
    out.moments = mesh_.moments;
    out.mesh.color = mesh_.mesh.color;
    for (const auto& p : position_)
        out.mesh.position.push_back(p.cast<float>());
    out.mesh.face = rough_.mesh.face;
    out.face_plane = rough_.face_plane;
    for (PlaneId p = 0; p < faces_.size(); ++p) {
        out.mesh.face.insert(out.mesh.face.end(), faces_[p].begin(), faces_[p].end());
        out.face_plane.insert(out.face_plane.end(), faces_[p].size(), p);
    }
    split_shared_chords(out);
    return out;
}

} // namespace

PlaneMesh remesh(PlaneMesh mesh, const SimplifyParams& params)
{
    Zones zones(std::move(mesh));
    while (true) { // in every turn flat zones lose faces, or are given up; without any this is the method qem
        Curves traced = zones.curves();
        const Flags flat = flat_zones(zones, traced, params);
        const PlaneMesh rough = zones.rough_part(flat, traced);
        Remesher remesher(rough, traced, flat, params);
        if (!remesher.run()) {
            zones.cut(remesher.failures(), params);
            continue;
        }
        const auto kept = std::count(flat.begin(), flat.end(), 0);
        log_info(fmt::format("{} planes and pieces of planes are filled anew, {} and knots keep their shape",
                             flat.size() - static_cast<std::size_t>(kept), kept));
        PlaneMesh result = remesher.result();
        zones.join(result);
        return result;
    }
}

} // namespace quoin
