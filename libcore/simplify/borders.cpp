#include "simplify/borders.h"

#include "mesh/creases.h"
#include "simplify/collapse_mesh.h"
#include "simplify/quadric.h"

#include <cmath>
#include <numbers>
#include <queue>
#include <tuple>

// A border vertex carries, weighted by the squared length l^2 of the dense edges around it, the quadrics of its planes,
// of the lines of those edges and of its own place; contracted vertices add up. Where two planes form a crease the
// minimum is moved onto the line in which they meet.

namespace quoin {
namespace {

constexpr int kMaxPasses = 8; // contractions open others; few are left after two or three passes

struct Candidate {
    double cost = 0.0;
    std::uint32_t first = 0, second = 0; // slots of the edge
    std::uint32_t first_version = 0, second_version = 0;

    bool operator>(const Candidate& other) const
    {
        return std::tie(cost, first, second) > std::tie(other.cost, other.first, other.second);
    }
};

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

// From the nearest point of the segment ab to p.
Eigen::Vector3d offset_from_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
    const Eigen::Vector3d ab = b - a;
    const double length = ab.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
    return p - a - t * ab;
}

class BorderSimplifier {
public:
    BorderSimplifier(const PlaneMesh& planes, Curves& curves, const SimplifyParams& params)
        : planes_(planes), curves_(curves), params_(params), mesh_(positions(planes.mesh), planes.mesh.face),
          version_(curves.size(), 0)
    {
        limits_ = {std::cos(radians(params.max_deviation)), std::cos(radians(params.max_turn)), params.min_shape};
        sum_quadrics();
    }

    std::size_t run()
    {
        const std::size_t before = remaining_;
        int pass = 0;
        while (pass < kMaxPasses && contract_all())
            ++pass;
        return before - remaining_;
    }

    void write(PlaneMesh& out) const;

private:
    static std::vector<Eigen::Vector3d> positions(const TriangleMesh& mesh)
    {
        std::vector<Eigen::Vector3d> p(mesh.position.size());
        for (std::size_t v = 0; v < p.size(); ++v)
            p[v] = mesh.position[v].cast<double>();
        return p;
    }
    bool corner(std::uint32_t slot) const { return planes_.vertex_class[curves_.vertex[slot]] == VertexClass::Corner; }
    const Eigen::Vector3d& position(std::uint32_t slot) const { return mesh_.position(curves_.vertex[slot]); }
    const Curve& curve(std::uint32_t slot) const { return curves_.curve[curves_.curve_of[slot]]; }
    std::vector<Plane> planes_of(const Curve& curve) const;

    void sum_quadrics();
    bool contract_all();
    void push(std::uint32_t first);
    Eigen::Vector3d target(std::uint32_t s, std::uint32_t t) const;
    bool try_contract(std::uint32_t s, std::uint32_t t);
    bool legal(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x);
    bool keeps_planes(VertexId u, VertexId v) const;
    bool on_border(VertexId u, VertexId v) const;
    bool fits(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x) const;
    bool within_error(const Eigen::Vector3d& offset, const Curve& curve) const;
    void contract(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x);

    const PlaneMesh& planes_;
    Curves& curves_;
    const SimplifyParams& params_;
    CollapseMesh mesh_;
    ShapeLimits limits_;
    std::vector<Quadric> quadric_;       // one per slot
    std::vector<std::uint32_t> version_; // one per slot
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> heap_;
    std::size_t remaining_ = 0; // edges of curves
    std::size_t keep_ = 0;      // of them at least
};

std::vector<Plane> BorderSimplifier::planes_of(const Curve& curve) const
{
    std::vector<Plane> planes{planes_.plane[curve.planes[0]]};
    if (curve.planes[1] != kNoPlane) planes.push_back(planes_.plane[curve.planes[1]]);
    return planes;
}

void BorderSimplifier::sum_quadrics()
{
    quadric_.assign(curves_.size(), {});
    std::size_t dense_edges = 0;
    for (const Curve& c : curves_.curve) {
        const auto planes = planes_of(c);
        const std::uint32_t edges = c.closed ? c.count : c.count - 1;
        dense_edges += edges;
        std::uint32_t owner = c.head; // the slot that is left and stands for those before the next one
        for (std::uint32_t i = 0; i < edges; ++i) {
            const std::uint32_t offset = c.head - c.first + i, s = c.first + offset % c.count,
                                t = c.first + (offset + 1) % c.count;
            if (curves_.left(s)) owner = s;
            const Eigen::Vector3d a = curves_.point[s], edge = curves_.point[t] - a;
            const double weight = 0.5 * edge.squaredNorm();
            if (!(weight > 0.0)) continue;
            Quadric q = Quadric::of_line(a, edge.normalized(), params_.line_weight * weight);
            for (const auto& plane : planes)
                q += Quadric::of_plane(plane, params_.plane_weight * weight);
            quadric_[owner] += q + Quadric::of_point(a, params_.point_weight * weight);
            quadric_[curves_.left(t) ? t : owner] +=
                q + Quadric::of_point(curves_.point[t], params_.point_weight * weight);
        }
    }
    keep_ = static_cast<std::size_t>(std::ceil(params_.border_ratio * static_cast<double>(dense_edges)));
    for (std::uint32_t s = 0; s < curves_.size(); ++s)
        remaining_ += curves_.next[s] != Curves::kNone ? 1 : 0;
}

bool BorderSimplifier::contract_all()
{
    const std::size_t before = remaining_;
    for (const Curve& c : curves_.curve) {
        std::uint32_t s = c.head;
        do {
            push(s);
            s = curves_.next[s];
        } while (s != Curves::kNone && s != c.head);
    }
    while (!heap_.empty() && remaining_ > keep_) {
        const Candidate best = heap_.top();
        heap_.pop();
        if (version_[best.first] == best.first_version && version_[best.second] == best.second_version)
            try_contract(best.first, best.second);
    }
    heap_ = {};
    return remaining_ < before;
}

void BorderSimplifier::push(std::uint32_t first)
{
    const std::uint32_t second = curves_.next[first];
    if (second == Curves::kNone || (corner(first) && corner(second))) return;
    const Eigen::Vector3d x = target(first, second);
    const double cost = (corner(first) ? 0.0 : quadric_[first](x)) + (corner(second) ? 0.0 : quadric_[second](x));
    heap_.push({std::max(cost, 0.0), first, second, version_[first], version_[second]});
}

Eigen::Vector3d BorderSimplifier::target(std::uint32_t s, std::uint32_t t) const
{
    if (corner(s)) return position(s);
    if (corner(t)) return position(t);
    const Eigen::Vector3d middle = 0.5 * (position(s) + position(t));
    const Eigen::Vector3d x = (quadric_[s] + quadric_[t]).minimizer(middle);
    const PlaneMeeting line = meet_planes(x, planes_of(curve(s)), radians(params_.crease_angle));
    return line.rank == 2 && (line.point - x).norm() <= params_.snap_distance ? line.point : x;
}

bool BorderSimplifier::try_contract(std::uint32_t s, std::uint32_t t)
{
    for (const Eigen::Vector3d& x : {target(s, t), position(s), position(t)}) {
        const bool moves_corner = (corner(s) && x != position(s)) || (corner(t) && x != position(t));
        if (moves_corner || !legal(s, t, x)) continue;
        contract(s, t, x);
        return true;
    }
    return false;
}

bool BorderSimplifier::legal(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x)
{
    const VertexId u = curves_.vertex[s], v = curves_.vertex[t];
    if (u == v || (curve(s).closed && curves_.next[curves_.next[t]] == s)) return false;
    if (!fits(s, t, x) || !mesh_.link_condition(u, v) || !keeps_planes(u, v)) return false;
    const auto plane_of = [&](FaceId f) -> const Plane& { return planes_.plane[planes_.face_plane[f]]; };
    return mesh_.keeps_shape(u, v, x, limits_, plane_of) && !mesh_.folds(u, v, x, limits_.folded_cosine);
}

// A face that dies between two other borders would be the last of its plane, or the bridge between two parts of it.
bool BorderSimplifier::keeps_planes(VertexId u, VertexId v) const
{
    std::array<FaceId, 2> faces{};
    const int count = mesh_.faces_on_edge(u, v, faces);
    for (int i = 0; i < count; ++i) {
        const VertexId w = mesh_.third_vertex(faces[static_cast<std::size_t>(i)], u, v);
        if (on_border(u, w) && on_border(v, w)) return false;
    }
    return true;
}

bool BorderSimplifier::on_border(VertexId u, VertexId v) const
{
    std::array<FaceId, 2> faces{};
    return mesh_.faces_on_edge(u, v, faces) != 2 || planes_.face_plane[faces[0]] != planes_.face_plane[faces[1]];
}

// Is every dense point between the neighbours of s and t near the polyline through x? It goes on for a vertex at both
// ends, for these have moved from their own dense points.
bool BorderSimplifier::fits(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x) const
{
    const Curve& c = curve(s);
    const std::uint32_t from = corner(s) ? s : curves_.previous[s], to = corner(t) ? t : curves_.next[t];
    const std::uint32_t ahead = corner(from) ? from : curves_.previous[from],
                        behind = corner(to) ? to : curves_.next[to];
    const std::array<Eigen::Vector3d, 5> line{position(ahead), position(from), x, position(to), position(behind)};
    for (std::uint32_t i = from;;) {
        Eigen::Vector3d nearest = offset_from_segment(curves_.point[i], line[0], line[1]);
        for (std::size_t k = 1; k + 1 < line.size(); ++k) {
            const Eigen::Vector3d offset = offset_from_segment(curves_.point[i], line[k], line[k + 1]);
            if (offset.squaredNorm() < nearest.squaredNorm()) nearest = offset;
        }
        if (!within_error(nearest, c)) return false;
        if (i == to) return true;
        i = i + 1 == c.first + c.count ? c.first : i + 1;
    }
}

bool BorderSimplifier::within_error(const Eigen::Vector3d& offset, const Curve& curve) const
{
    if (curve.planes[1] == kNoPlane) return offset.norm() <= params_.max_open_error;
    for (const PlaneId p : curve.planes)
        if (std::abs(planes_.plane[p].normal.dot(offset)) > params_.max_error) return false;
    return offset.norm() <= params_.max_border_shift;
}

void BorderSimplifier::contract(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x)
{
    const bool keep_second = corner(t);
    const std::uint32_t kept = keep_second ? t : s, gone = keep_second ? s : t;
    mesh_.move(curves_.vertex[kept], x);
    mesh_.contract(curves_.vertex[kept], curves_.vertex[gone]);
    const std::uint32_t previous = curves_.previous[gone], next = curves_.next[gone];
    if (previous != Curves::kNone) curves_.next[previous] = next;
    if (next != Curves::kNone) curves_.previous[next] = previous;
    curves_.next[gone] = curves_.previous[gone] = Curves::kNone;
    Curve& c = curves_.curve[curves_.curve_of[kept]];
    if (gone == c.head) c.head = kept;
    quadric_[kept] += quadric_[gone];
    ++version_[gone];
    ++version_[kept];
    --remaining_;
    if (curves_.previous[kept] != Curves::kNone) push(curves_.previous[kept]);
    push(kept);
}

void BorderSimplifier::write(PlaneMesh& out) const
{
    std::vector<Face> face;
    std::vector<PlaneId> face_plane;
    for (FaceId f = 0; f < mesh_.face_count(); ++f) {
        if (!mesh_.alive(f)) continue;
        face.push_back(mesh_.face(f));
        face_plane.push_back(planes_.face_plane[f]);
    }
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v)
        out.mesh.position[v] = mesh_.position(v).cast<float>();
    out.mesh.face = std::move(face);
    out.face_plane = std::move(face_plane);
}

} // namespace

std::size_t simplify_borders(PlaneMesh& mesh, Curves& curves, const SimplifyParams& params)
{
    const PlaneMesh before = mesh;
    BorderSimplifier simplifier(before, curves, params);
    const std::size_t contracted = simplifier.run();
    simplifier.write(mesh);
    return contracted;
}

} // namespace quoin
