#include "simplify/inner.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/units.h"
#include "simplify/patch.h"
#include "simplify/quadric.h"

#include <cmath>
#include <numeric>
#include <queue>

// Every vertex carries the quadric Q of its dense faces, their area a and centroid c (a third of each face's), and the
// part a' of the area that lies on the plane. With the distance d(x) to the plane, the cost of a vertex at x is
//     w_f Q(x) + w_p a' d(x)^2 + w_v a |x - c|^2    [m^4].

namespace quoin {
namespace {

constexpr int kInnerPasses = 8;    // contractions open others; few are left after two or three passes
constexpr int kDelaunaySweeps = 8; // flips die out geometrically

struct InnerQuadric {
    Quadric faces;
    double area = 0.0;                               // [m^2]
    double planar_area = 0.0;                        // [m^2]
    Eigen::Vector3d first = Eigen::Vector3d::Zero(); // area times centroid [m^3]

    friend InnerQuadric operator+(const InnerQuadric& a, const InnerQuadric& b)
    {
        return {a.faces + b.faces, a.area + b.area, a.planar_area + b.planar_area, a.first + b.first};
    }
};

struct InnerContraction {
    double cost = 0.0;
    VertexId from = 0, to = 0; // `from` is inner and goes; when both are inner, from > to
    std::uint32_t from_version = 0, to_version = 0;

    bool operator>(const InnerContraction& other) const
    {
        return std::tie(cost, from, to) > std::tie(other.cost, other.from, other.to);
    }
};

class PatchSimplifier {
public:
    PatchSimplifier(Patch& patch, const SimplifyParams& params)
        : patch_(patch), mesh_(patch.mesh), params_(params), quadric_(patch.inner_count),
          version_(mesh_.vertex_count(), 0), remaining_(patch.inner_count),
          keep_(static_cast<std::size_t>(std::ceil(params.inner_ratio * patch.inner_count)))
    {
        limits_ = {std::cos(radians(params.max_deviation)), std::cos(radians(params.max_turn)), params.min_shape};
        sum_quadrics();
    }

    void run()
    {
        for (int pass = 0; pass < kInnerPasses; ++pass) {
            const bool contracted = contract_all();
            const bool flipped = params_.improve_shape && flip_to_delaunay(patch_, limits_, kDelaunaySweeps) > 0;
            if (!contracted && (!flipped || pass > 0)) break;
        }
    }

private:
    bool on_plane(const Face& face) const
    {
        return std::all_of(face.begin(), face.end(), [&](VertexId v) {
            return std::abs(patch_.plane.signed_distance(mesh_.position(v))) <= params_.snap_distance;
        });
    }
    void sum_quadrics();
    bool contract_all();
    void collect_candidates();
    void mark_turned();
    bool folds(VertexId from, VertexId to, const Eigen::Vector3d& x);
    void push(VertexId u, VertexId v);
    void push_around(VertexId v);
    Eigen::Vector3d target(VertexId from, VertexId to) const;
    double cost(const InnerQuadric& q, const Eigen::Vector3d& x) const;
    bool within_error(VertexId from, VertexId to, const Eigen::Vector3d& x) const;
    bool claims_chords(VertexId from, VertexId to);
    bool legal(VertexId from, VertexId to, const Eigen::Vector3d& x);
    void contract(VertexId from, VertexId to, const Eigen::Vector3d& x);

    Patch& patch_;
    CollapseMesh& mesh_;
    const SimplifyParams& params_;
    ShapeLimits limits_;
    std::vector<InnerQuadric> quadric_;  // inner vertices
    std::vector<std::uint32_t> version_; // of a vertex's quadric and faces
    std::priority_queue<InnerContraction, std::vector<InnerContraction>, std::greater<>> heap_;
    std::vector<VertexId> ring_;
    std::vector<std::uint8_t> turned_; // one a vertex: can a face at it look away from the plane?
    std::size_t remaining_;            // inner vertices
    std::size_t keep_;                 // of them at least
};

void PatchSimplifier::sum_quadrics()
{
    for (FaceId f = 0; f < mesh_.face_count(); ++f) {
        const auto& [i, j, k] = mesh_.face(f);
        const Eigen::Vector3d a = mesh_.position(i), n = (mesh_.position(j) - a).cross(mesh_.position(k) - a);
        const double length = n.norm(), area = length / 6.0; // a third of the face's
        if (!(length > 0.0)) continue;
        const Plane plane{n / length, -a.dot(n) / length};
        const InnerQuadric q{Quadric::of_plane(plane, area), area, on_plane(mesh_.face(f)) ? area : 0.0,
                             area / 3.0 * (a + mesh_.position(j) + mesh_.position(k))};
        for (const VertexId v : mesh_.face(f))
            if (patch_.inner(v)) quadric_[v] = quadric_[v] + q;
    }
}

bool PatchSimplifier::contract_all()
{
    const std::size_t before = remaining_;
    mark_turned();
    collect_candidates();
    while (!heap_.empty() && remaining_ > keep_) {
        const InnerContraction best = heap_.top();
        heap_.pop();
        if (version_[best.from] != best.from_version || version_[best.to] != best.to_version) continue;
        const Eigen::Vector3d x = target(best.from, best.to);
        if (legal(best.from, best.to, x)) contract(best.from, best.to, x);
    }
    heap_ = {};
    return remaining_ < before;
}

void PatchSimplifier::collect_candidates()
{
    for (VertexId v = 0; v < patch_.inner_count; ++v) {
        mesh_.neighbours(v, ring_);
        for (const VertexId w : ring_)
            if (w < v || !patch_.inner(w)) push(v, w);
    }
}

void PatchSimplifier::push(VertexId u, VertexId v)
{
    if (!patch_.inner(u) || (patch_.inner(v) && u < v)) std::swap(u, v);
    if (!patch_.inner(u)) return;
    const Eigen::Vector3d x = target(u, v);
    const double total = cost(quadric_[u], x) + (patch_.inner(v) ? cost(quadric_[v], x) : 0.0);
    heap_.push({total, u, v, version_[u], version_[v]});
}

void PatchSimplifier::push_around(VertexId v)
{
    mesh_.neighbours(v, ring_);
    for (const VertexId w : ring_)
        push(v, w);
}

Eigen::Vector3d PatchSimplifier::target(VertexId from, VertexId to) const
{
    if (!patch_.inner(to)) return mesh_.position(to);
    const InnerQuadric q = quadric_[from] + quadric_[to];
    Quadric total = Quadric::of_plane(patch_.plane, params_.plane_weight * q.planar_area);
    total.A += params_.face_weight * q.faces.A + params_.point_weight * q.area * Eigen::Matrix3d::Identity();
    total.b += params_.face_weight * q.faces.b - params_.point_weight * q.first;
    return total.minimizer(0.5 * (mesh_.position(from) + mesh_.position(to)));
}

double PatchSimplifier::cost(const InnerQuadric& q, const Eigen::Vector3d& x) const
{
    if (!(q.area > 0.0)) return 0.0;
    const double d = patch_.plane.signed_distance(x);
    const double spread = (x - q.first / q.area).squaredNorm();
    return params_.face_weight * q.faces(x) + params_.plane_weight * q.planar_area * d * d +
           params_.point_weight * q.area * spread;
}

bool PatchSimplifier::within_error(VertexId from, VertexId to, const Eigen::Vector3d& x) const
{
    if (params_.max_inner_error <= 0.0) return true;
    const double bound = params_.max_inner_error * params_.max_inner_error;
    const auto fits = [&](const InnerQuadric& q) { return q.faces(x) <= bound * q.area; };
    return fits(quadric_[from]) && (!patch_.inner(to) || fits(quadric_[to]));
}

// May all edges and faces that contracting `from` into the border vertex `to` makes between border vertices be made
// here?
bool PatchSimplifier::claims_chords(VertexId from, VertexId to)
{
    bool allowed = true;
    mesh_.neighbours(from, ring_);
    for (const VertexId x : ring_)
        allowed = allowed && (x == to || patch_.inner(x) || mesh_.adjacent(to, x) || patch_.may_join(to, x));
    mesh_.for_each_face(from, [&](FaceId f) {
        if (!allowed || mesh_.contains(f, to)) return;
        const auto& t = mesh_.face(f);
        const VertexId x = t[0] == from ? t[1] : t[0], y = mesh_.third_vertex(f, from, x);
        allowed = patch_.may_fill(to, x, y);
    });
    return allowed;
}

bool PatchSimplifier::legal(VertexId from, VertexId to, const Eigen::Vector3d& x)
{
    if (!within_error(from, to, x) || !mesh_.link_condition(from, to)) return false;
    const auto plane_of = [&](FaceId) -> const Plane& { return patch_.plane; };
    if (!mesh_.fan_keeps_shape(from, to, x, limits_, plane_of)) return false;
    if (patch_.inner(to) ? !mesh_.fan_keeps_shape(to, from, x, limits_, plane_of) : !claims_chords(from, to))
        return false;
    return !folds(from, to, x);
}

// Contractions turn no face away from the plane that was not before.
void PatchSimplifier::mark_turned()
{
    turned_.assign(mesh_.vertex_count(), 0);
    for (FaceId f = 0; f < mesh_.face_count(); ++f) {
        if (!mesh_.alive(f)) continue;
        const auto& [a, b, c] = mesh_.face(f);
        const Eigen::Vector3d n = (mesh_.position(b) - mesh_.position(a)).cross(mesh_.position(c) - mesh_.position(a));
        if (n.dot(patch_.plane.normal) > 0.0) continue;
        for (const VertexId v : mesh_.face(f))
            turned_[v] = 1;
    }
}

// Faces near the plane's direction fold with none but those that look away from it.
bool PatchSimplifier::folds(VertexId from, VertexId to, const Eigen::Vector3d& x)
{
    const double folded = limits_.folded_cosine, near = std::sqrt(1.0 - folded * folded);
    bool turned = turned_[from] != 0 || turned_[to] != 0;
    for (const VertexId v : {from, to}) {
        mesh_.neighbours(v, ring_);
        for (const VertexId w : ring_)
            turned = turned || turned_[w] != 0;
    }
    if (!turned && mesh_.least_facing(from, to, x, patch_.plane.normal) > near) return false;
    return mesh_.folds(from, to, x, folded);
}

void PatchSimplifier::contract(VertexId from, VertexId to, const Eigen::Vector3d& x)
{
    --remaining_;
    ++version_[from];
    turned_[to] |= turned_[from];
    if (patch_.inner(to)) {
        quadric_[to] = quadric_[to] + quadric_[from];
        ++version_[to];
        mesh_.move(to, x);
        mesh_.contract(to, from);
        push_around(to);
        return;
    }
    mesh_.neighbours(from, ring_);
    mesh_.contract(to, from);
    for (const VertexId w : ring_)
        if (patch_.inner(w)) push(w, to);
}

std::vector<PlaneId> largest_first(const PatchIndex& index, std::size_t planes)
{
    std::vector<PlaneId> order(planes);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](PlaneId a, PlaneId b) { return index.size(a) > index.size(b); });
    return order;
}

// The faces left in a patch, in vertices of the plane mesh.
std::vector<Face> remaining_faces(const Patch& patch)
{
    std::vector<Face> faces;
    for (FaceId f = 0; f < patch.mesh.face_count(); ++f) {
        if (!patch.mesh.alive(f)) continue;
        const auto& [a, b, c] = patch.mesh.face(f);
        faces.push_back({patch.global[a], patch.global[b], patch.global[c]});
    }
    return faces;
}

} // namespace

void simplify_inner(PlaneMesh& mesh, const SimplifyParams& params)
{
    const PatchIndex index(mesh);
    const auto order = largest_first(index, mesh.plane.size());
    std::vector<std::vector<Face>> faces(mesh.plane.size());
    auto position = mesh.mesh.position; // every inner vertex is written by its own plane
    Progress progress("simplifying inside planes", mesh.mesh.face.size());
    parallel_for(order.size(), [&](std::size_t i) {
        Patch patch = index.extract(order[i]);
        PatchSimplifier(patch, params).run();
        faces[order[i]] = remaining_faces(patch);
        for (VertexId v = 0; v < patch.inner_count; ++v)
            position[patch.global[v]] = (patch.mesh.position(v) + patch.origin).cast<float>();
        progress.step(index.size(order[i]));
    });
    mesh.mesh.position = std::move(position);
    mesh.mesh.face.clear();
    mesh.face_plane.clear();
    for (PlaneId p = 0; p < faces.size(); ++p) {
        mesh.mesh.face.insert(mesh.mesh.face.end(), faces[p].begin(), faces[p].end());
        mesh.face_plane.insert(mesh.face_plane.end(), faces[p].size(), p);
    }
}

} // namespace quoin
