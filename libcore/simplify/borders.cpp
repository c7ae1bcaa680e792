#include "simplify/borders.h"

#include "geometry/units.h"
#include "simplify/collapse_mesh.h"
#include "simplify/curve_fit.h"

#include <cmath>
#include <queue>
#include <tuple>

namespace quoin {
namespace {

constexpr int kBorderPasses = 8; // contractions open others; few are left after two or three passes

struct BorderContraction {
    double cost = 0.0;
    std::uint32_t first = 0, second = 0; // slots of the edge
    std::uint32_t first_version = 0, second_version = 0;

    bool operator>(const BorderContraction& other) const
    {
        return std::tie(cost, first, second) > std::tie(other.cost, other.first, other.second);
    }
};

class BorderSimplifier {
public:
    BorderSimplifier(const PlaneMesh& planes, Curves& curves, const SimplifyParams& params)
        : planes_(planes), curves_(curves), params_(params), mesh_(doubles(planes.mesh.position), planes.mesh.face),
          fit_(planes, curves, mesh_.positions(), params), version_(curves.size(), 0), refused_(curves.size(), 0),
          changed_(planes.mesh.position.size(), 0)
    {
        limits_ = {std::cos(radians(params.max_deviation)), std::cos(radians(params.max_turn)), params.min_shape};
        sum_quadrics();
    }

    std::size_t run()
    {
        const std::size_t before = remaining_;
        int pass = 0;
        while (pass < kBorderPasses && contract_all())
            ++pass;
        return before - remaining_;
    }

    void write(PlaneMesh& out) const;

private:
    bool corner(std::uint32_t slot) const { return fit_.corner(slot); }
    const Eigen::Vector3d& position(std::uint32_t slot) const { return fit_.position(slot); }

    void sum_quadrics();
    bool contract_all();
    void push(std::uint32_t first);
    bool is_still_refused(std::uint32_t s, std::uint32_t t) const;
    void note_change(VertexId v);
    bool try_contract(std::uint32_t s, std::uint32_t t);
    bool legal(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x);
    void contract(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x);

    const PlaneMesh& planes_;
    Curves& curves_;
    const SimplifyParams& params_;
    CollapseMesh mesh_;
    CurveFit fit_;
    ShapeLimits limits_;
    std::vector<Quadric> quadric_;       // one per slot
    std::vector<std::uint32_t> version_; // one per slot
    std::uint32_t now_ = 1;              // grows with every contraction
    std::vector<std::uint32_t> refused_; // one per slot: when the edge that begins there was found to stay
    std::vector<std::uint32_t> changed_; // V: when a face or a curve there changed
    std::priority_queue<BorderContraction, std::vector<BorderContraction>, std::greater<>> heap_;
    std::size_t remaining_ = 0; // edges of curves
    std::size_t keep_ = 0;      // of them at least
};

void BorderSimplifier::sum_quadrics()
{
    quadric_.assign(curves_.size(), {});
    std::size_t dense_edges = 0;
    for (const Curve& c : curves_.curve) {
        if (!c.in_mesh) continue;
        fit_.add_quadrics(c, quadric_);
        dense_edges += curves_.edges(c);
        for (std::uint32_t s = c.first; s < c.first + c.count; ++s)
            remaining_ += curves_.next[s] != Curves::kNone ? 1 : 0;
    }
    keep_ = static_cast<std::size_t>(std::ceil(params_.border_ratio * static_cast<double>(dense_edges)));
}

bool BorderSimplifier::contract_all()
{
    const std::size_t before = remaining_;
    for (const Curve& c : curves_.curve) {
        if (!c.in_mesh) continue;
        std::uint32_t s = c.head;
        do {
            push(s);
            s = curves_.next[s];
        } while (s != Curves::kNone && s != c.head);
    }
    while (!heap_.empty() && remaining_ > keep_) {
        const BorderContraction best = heap_.top();
        heap_.pop();
        if (version_[best.first] != best.first_version || version_[best.second] != best.second_version) continue;
        if (!is_still_refused(best.first, best.second) && !try_contract(best.first, best.second))
            refused_[best.first] = now_;
    }
    heap_ = {};
    return remaining_ < before;
}

void BorderSimplifier::push(std::uint32_t first)
{
    const std::uint32_t second = curves_.next[first];
    if (second == Curves::kNone || (corner(first) && corner(second))) return;
    heap_.push({fit_.cost(first, second, fit_.target(first, second, quadric_), quadric_), first, second,
                version_[first], version_[second]});
}

// Has nothing changed that was asked when the edge was refused: the faces around its ends and those beside these, and
// the curve to both sides?
bool BorderSimplifier::is_still_refused(std::uint32_t s, std::uint32_t t) const
{
    const std::uint32_t since = refused_[s];
    if (since == 0) return false;
    bool same = true;
    const auto look_at = [&](std::uint32_t slot) { same = same && changed_[curves_.vertex[slot]] < since; };
    for (std::uint32_t i = 0, slot = s; i < 2 && !corner(slot); ++i)
        look_at(slot = curves_.previous[slot]);
    for (std::uint32_t i = 0, slot = t; i < 2 && !corner(slot); ++i)
        look_at(slot = curves_.next[slot]);
    for (const std::uint32_t end : {s, t})
        mesh_.for_each_face(curves_.vertex[end], [&](FaceId f) {
            for (const VertexId v : mesh_.face(f))
                same = same && changed_[v] < since;
        });
    return same;
}

// Of the faces of a vertex.
void BorderSimplifier::note_change(VertexId v)
{
    mesh_.for_each_face(v, [&](FaceId f) {
        for (const VertexId w : mesh_.face(f))
            changed_[w] = now_;
    });
}

bool BorderSimplifier::try_contract(std::uint32_t s, std::uint32_t t)
{
    for (const Eigen::Vector3d& x : {fit_.target(s, t, quadric_), position(s), position(t)}) {
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
    if (u == v || (fit_.curve(s).closed && curves_.next[curves_.next[t]] == s)) return false;
    if (!fit_.fits(s, t, x, nullptr) || !mesh_.link_condition(u, v) || !keeps_planes(mesh_, planes_.face_plane, u, v))
        return false;
    const auto plane_of = [&](FaceId f) -> const Plane& { return planes_.plane[planes_.face_plane[f]]; };
    return mesh_.keeps_shape(u, v, x, limits_, plane_of) && !mesh_.folds(u, v, x, limits_.folded_cosine);
}

void BorderSimplifier::contract(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x)
{
    const bool keep_second = corner(t);
    const std::uint32_t kept = keep_second ? t : s, gone = keep_second ? s : t;
    for (const VertexId v : {curves_.vertex[kept], curves_.vertex[gone]})
        note_change(v);
    ++now_;
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
