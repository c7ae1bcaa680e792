#include "simplify/unfold.h"

#include "base/log.h"
#include "simplify/collapse_mesh.h"
#include "simplify/zero_area.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace quoin {
namespace {

constexpr double kFoldedCosine = -0.5; // between faces on one edge
// How bad a face without area and one that looks away are, in folded edges: the rim of a sheet may be one in the end.
constexpr int kZeroWeight = 4, kFlippedWeight = 2;
constexpr int kUnfoldPasses = 8;         // few defects are left after two or three
constexpr std::size_t kLargestFan = 100; // [faces] that may move at once; all pairs of them are looked at

// A face of a neighbourhood, as it is or as it would be.
struct Piece {
    Face vertex{};
    Triangle corner;
    PlaneId plane = 0;
};
using Pieces = std::vector<Piece>;

Eigen::Vector3d middle(const Triangle& t) { return (t[0] + t[1] + t[2]) / 3.0; }

double squared_distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
    const Eigen::Vector3d ab = b - a;
    const double length = ab.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
    return (p - a - t * ab).squaredNorm();
}

double squared_distance(const Eigen::Vector3d& p, const Triangle& t)
{
    const Eigen::Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]);
    double least = std::numeric_limits<double>::infinity();
    bool above = n.squaredNorm() > 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3d &a = t[k], &b = t[(k + 1) % 3];
        above = above && n.dot((b - a).cross(p - a)) >= 0.0;
        least = std::min(least, squared_distance_to_segment(p, a, b));
    }
    return above ? std::pow(n.dot(p - t[0]), 2) / n.squaredNorm() : least;
}

double distance(const Eigen::Vector3d& p, const Pieces& pieces)
{
    double least = std::numeric_limits<double>::infinity();
    for (const Piece& piece : pieces)
        least = std::min(least, squared_distance(p, piece.corner));
    return std::sqrt(least);
}

bool is_corner(const Eigen::Vector3d& p, const Pieces& pieces)
{
    return std::any_of(pieces.begin(), pieces.end(),
                       [&](const Piece& piece) { return std::ranges::find(piece.corner, p) != piece.corner.end(); });
}

// Corners and middles of `from` are that far from `to` at most; the first that is farther than `enough` ends it.
double farthest(const Pieces& from, const Pieces& to, double enough)
{
    double most = 0.0;
    for (const Piece& piece : from) {
        for (const auto& corner : piece.corner)
            if (most <= enough && !is_corner(corner, to)) most = std::max(most, distance(corner, to));
        if (most <= enough) most = std::max(most, distance(middle(piece.corner), to));
    }
    return most;
}

bool shares_edge(const Face& a, const Face& b)
{
    int shared = 0;
    for (const VertexId v : a)
        shared += static_cast<int>(std::count(b.begin(), b.end(), v));
    return shared == 2;
}

// Of faces that share an edge: do they run along it the same way, as where a patch of the mesh is turned over?
bool runs_same_way(const Face& a, const Face& b)
{
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t j = 0; j < 3; ++j)
            if (a[k] == b[j] && a[(k + 1) % 3] == b[(j + 1) % 3]) return true;
    return false;
}

bool is_folded(const Piece& a, const Piece& b, double cosine)
{
    if (std::abs(cosine) <= -kFoldedCosine || !shares_edge(a.vertex, b.vertex)) return false;
    return (runs_same_way(a.vertex, b.vertex) ? -cosine : cosine) < kFoldedCosine;
}

auto flat_count(const Pieces& pieces)
{
    return std::ranges::count_if(pieces, [](const Piece& piece) { return !has_area(piece.corner); });
}

// Defects of the first `inner` pieces and of their edges, weighted.
int defects(const Pieces& pieces, std::size_t inner, const std::vector<Plane>& planes)
{
    std::vector<Eigen::Vector3d> normal;
    int count = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Triangle& t = pieces[i].corner;
        const TriangleShape shape = triangle_shape(t[0], t[1], t[2]);
        normal.push_back(shape.normal);
        if (i >= inner) continue;
        if (!has_area(t)) count += kZeroWeight;
        if (shape.normal.dot(planes[pieces[i].plane].normal) < 0.0) count += kFlippedWeight;
    }
    for (std::size_t i = 0; i < inner; ++i)
        for (std::size_t j = i + 1; j < pieces.size(); ++j)
            if (is_folded(pieces[i], pieces[j], normal[i].dot(normal[j]))) ++count;
    return count;
}

// One way to change the mesh, and what is gained.
struct Change {
    enum class Kind { Contraction, Flip, OtherPlane };
    Kind kind = Kind::Contraction;
    VertexId kept = 0, gone = 0;   // of a contraction; the ends of the edge that is flipped
    std::array<FaceId, 2> faces{}; // of the edge that is flipped; the first goes over to another plane
    PlaneId plane = 0;             // that it goes over to
    Eigen::Vector3d target = Eigen::Vector3d::Zero();
    int defects = 0; // fewer than now, counted as a negative number
    double error = 0.0;

    bool better_than(const Change& other) const
    {
        return std::tie(defects, error) < std::tie(other.defects, other.error);
    }
};

class Unfolder {
public:
    Unfolder(const PlaneMesh& mesh, const SimplifyParams& params)
        : planes_(mesh), params_(params), mesh_(doubles(mesh.mesh.position), mesh.mesh.face),
          stirred_(mesh.mesh.face.size(), 1)
    {
    }

    std::size_t run()
    {
        std::size_t changes = 0;
        for (int pass = 0; pass < kUnfoldPasses; ++pass) {
            const std::size_t before = changes;
            for (FaceId f = 0; f < mesh_.face_count(); ++f) {
                if (std::exchange(stirred_[f], std::uint8_t{0}) == 0) continue;
                while (mesh_.alive(f) && is_defective(f) && improve(f))
                    ++changes;
            }
            if (changes == before) break;
        }
        return changes;
    }

    void write(PlaneMesh& out) const;

private:
    Piece piece(FaceId f) const
    {
        const Face& t = mesh_.face(f);
        return {t, {mesh_.position(t[0]), mesh_.position(t[1]), mesh_.position(t[2])}, planes_.face_plane[f]};
    }
    std::vector<FaceId> around(std::initializer_list<VertexId> vertices) const;
    std::vector<FaceId> beside(const std::vector<FaceId>& inner) const;
    Pieces pieces(const std::vector<FaceId>& faces) const;
    bool is_defective(FaceId f) const;
    bool improve(FaceId f);
    bool may_lose_faces_between(VertexId kept, VertexId gone);
    void try_contraction(VertexId kept, VertexId gone, std::optional<Change>& best);
    void try_flip(FaceId f, VertexId a, VertexId b, std::optional<Change>& best) const;
    void try_other_planes(FaceId f, std::optional<Change>& best) const;
    void apply(const Change& change);
    void stir(VertexId v);
    void consider(Change change, const std::vector<FaceId>& inner, const Pieces& after,
                  std::optional<Change>& best) const;
    bool open(VertexId v) const;

    PlaneMesh planes_; // its faces are as they were
    const SimplifyParams& params_;
    CollapseMesh mesh_;
    std::vector<std::uint8_t> stirred_; // F; has something changed nearby since the face was looked at?
};

// Faces of the given vertices, each once.
std::vector<FaceId> Unfolder::around(std::initializer_list<VertexId> vertices) const
{
    std::vector<FaceId> faces;
    for (const VertexId v : vertices)
        mesh_.for_each_face(v, [&](FaceId f) { faces.push_back(f); });
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
}

// Faces that share an edge with these and are none of them.
std::vector<FaceId> Unfolder::beside(const std::vector<FaceId>& inner) const
{
    std::vector<FaceId> outer;
    for (const FaceId f : inner)
        for (std::size_t k = 0; k < 3; ++k) {
            VertexId a = mesh_.face(f)[k], b = mesh_.face(f)[(k + 1) % 3];
            if (mesh_.has_fewer_faces(b, a)) std::swap(a, b);
            mesh_.for_each_face(a, [&](FaceId g) {
                if (shares_edge(mesh_.face(f), mesh_.face(g)) && mesh_.contains(g, b) &&
                    !std::binary_search(inner.begin(), inner.end(), g))
                    outer.push_back(g);
            });
        }
    std::sort(outer.begin(), outer.end());
    outer.erase(std::unique(outer.begin(), outer.end()), outer.end());
    return outer;
}

Pieces Unfolder::pieces(const std::vector<FaceId>& faces) const
{
    Pieces result;
    for (const FaceId f : faces)
        result.push_back(piece(f));
    return result;
}

bool Unfolder::is_defective(FaceId f) const
{
    Pieces all{piece(f)};
    for (const FaceId g : beside({f}))
        all.push_back(piece(g));
    return defects(all, 1, planes_.plane) > 0;
}

// Applies the change of the face's or its neighbours' edges that gains most. Is there one?
bool Unfolder::improve(FaceId f)
{
    std::vector<FaceId> candidates = beside({f});
    candidates.push_back(f);
    std::optional<Change> best;
    for (const FaceId g : candidates) {
        const Face face = mesh_.face(g);
        for (std::size_t k = 0; k < 3; ++k) {
            try_contraction(face[k], face[(k + 1) % 3], best);
            try_contraction(face[(k + 1) % 3], face[k], best);
            try_flip(g, face[k], face[(k + 1) % 3], best);
        }
    }
    try_other_planes(f, best);
    if (!best) return false;
    apply(*best);
    stir(best->kind == Change::Kind::OtherPlane ? mesh_.face(best->faces[0])[0] : best->kept);
    return true;
}

// Faces that share vertices with those around the vertex are to be looked at again.
void Unfolder::stir(VertexId v)
{
    std::vector<VertexId> near{v};
    for (int ring = 0; ring < 2; ++ring) {
        std::vector<VertexId> wider;
        for (const VertexId w : near)
            mesh_.for_each_face(w, [&](FaceId f) { std::ranges::copy(mesh_.face(f), std::back_inserter(wider)); });
        std::ranges::sort(wider);
        wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
        near = std::move(wider);
    }
    for (const VertexId w : near)
        mesh_.for_each_face(w, [&](FaceId f) { stirred_[f] = 1; });
}

void Unfolder::apply(const Change& change)
{
    switch (change.kind) {
    case Change::Kind::Contraction:
        mesh_.move(change.kept, change.target);
        return mesh_.contract(change.kept, change.gone);
    case Change::Kind::Flip:
        return mesh_.flip(change.faces[0], change.faces[1], change.kept, change.gone);
    case Change::Kind::OtherPlane:
        planes_.face_plane[change.faces[0]] = change.plane;
    }
}

// Do planes stay in one piece, and keep a face, when the edge is contracted? All but those of a single bad face.
bool Unfolder::may_lose_faces_between(VertexId kept, VertexId gone)
{
    if (keeps_planes(mesh_, planes_.face_plane, kept, gone)) return true;
    std::array<FaceId, 2> faces{};
    const int count = mesh_.faces_on_edge(kept, gone, faces);
    for (int i = 0; i < count; ++i) {
        const auto neighbours = beside({faces[i]});
        PlaneId& plane = planes_.face_plane[faces[i]];
        const auto in_plane = [&](FaceId g) { return planes_.face_plane[g] == plane; };
        if (neighbours.empty() || std::ranges::any_of(neighbours, in_plane) || !is_defective(faces[i])) continue;
        const PlaneId own = std::exchange(plane, planes_.face_plane[neighbours[0]]); // as if it were given away
        const bool keeps = keeps_planes(mesh_, planes_.face_plane, kept, gone);
        plane = own;
        if (keeps) return true;
    }
    return false;
}

void Unfolder::try_contraction(VertexId kept, VertexId gone, std::optional<Change>& best)
{
    std::array<FaceId, 2> faces{};
    const bool pinches = open(kept) && open(gone) && mesh_.faces_on_edge(kept, gone, faces) == 2;
    if (pinches || !mesh_.link_condition(kept, gone) || !may_lose_faces_between(kept, gone)) return;
    auto inner = around({gone});
    if (inner.size() > kLargestFan) return;
    const auto both = around({kept, gone});
    const Eigen::Vector3d middle = 0.5 * (mesh_.position(kept) + mesh_.position(gone));
    std::vector<Eigen::Vector3d> targets{mesh_.position(kept)};
    if (both.size() <= kLargestFan) { // or `kept` and its faces stay
        inner = both;
        targets.emplace_back(middle.cast<float>().cast<double>()); // as they are written
    }
    for (const Eigen::Vector3d& target : targets) {
        Pieces after;
        for (const FaceId f : inner) {
            if (mesh_.contains(f, kept) && mesh_.contains(f, gone)) continue;
            after.push_back(piece(f));
            for (std::size_t k = 0; k < 3; ++k)
                if (VertexId& v = after.back().vertex[k]; v == kept || v == gone) {
                    v = kept;
                    after.back().corner[k] = target;
                }
        }
        consider({.kept = kept, .gone = gone, .target = target}, inner, after, best);
    }
}

void Unfolder::try_flip(FaceId f, VertexId a, VertexId b, std::optional<Change>& best) const
{
    std::array<FaceId, 2> faces{};
    if (mesh_.faces_on_edge(a, b, faces) != 2) return;
    const FaceId g = faces[0] == f ? faces[1] : faces[0];
    const VertexId c = mesh_.third_vertex(f, a, b), d = mesh_.third_vertex(g, a, b);
    if (planes_.face_plane[f] != planes_.face_plane[g] || c == d || mesh_.adjacent(c, d)) return;
    const auto at = [&](VertexId v) { return mesh_.position(v); };
    const PlaneId plane = planes_.face_plane[f];
    const Pieces after{{{c, d, b}, {at(c), at(d), at(b)}, plane}, {{d, c, a}, {at(d), at(c), at(a)}, plane}};
    consider({.kind = Change::Kind::Flip, .kept = a, .gone = b, .faces = {f, g}}, {std::min(f, g), std::max(f, g)},
             after, best);
}

// A face with a single neighbour in its own plane leaves that in one piece.
void Unfolder::try_other_planes(FaceId f, std::optional<Change>& best) const
{
    const PlaneId plane = planes_.face_plane[f];
    const auto neighbours = beside({f});
    if (std::count_if(neighbours.begin(), neighbours.end(), [&](FaceId g) { return planes_.face_plane[g] == plane; }) !=
        1)
        return;
    for (const FaceId g : neighbours) {
        if (planes_.face_plane[g] == plane) continue;
        Pieces after{piece(f)};
        after[0].plane = planes_.face_plane[g];
        consider({.kind = Change::Kind::OtherPlane, .faces = {f, g}, .plane = planes_.face_plane[g]}, {f}, after, best);
    }
}

void Unfolder::consider(Change change, const std::vector<FaceId>& inner, const Pieces& after,
                        std::optional<Change>& best) const
{
    const Pieces outer = pieces(beside(inner));
    const auto with_outer = [&](Pieces list) {
        list.insert(list.end(), outer.begin(), outer.end());
        return list;
    };
    const Pieces before = pieces(inner);
    change.defects = defects(with_outer(after), after.size(), planes_.plane) -
                     defects(with_outer(before), before.size(), planes_.plane);
    if (change.defects >= 0 || after.empty() || flat_count(after) > flat_count(before)) return;
    change.error = farthest(before, with_outer(after), params_.max_fold_error);
    if (change.error > params_.max_fold_error) return;
    change.error = std::max(change.error, farthest(after, before, params_.max_fold_error));
    if (change.error <= params_.max_fold_error && (!best || change.better_than(*best))) best = change;
}

// Is the vertex on a border of the mesh?
bool Unfolder::open(VertexId v) const
{
    bool found = false;
    std::array<FaceId, 2> faces{};
    mesh_.for_each_face(v, [&](FaceId f) {
        for (const VertexId w : mesh_.face(f))
            found = found || (w != v && mesh_.faces_on_edge(v, w, faces) == 1);
    });
    return found;
}

void Unfolder::write(PlaneMesh& out) const
{
    out.mesh.face.clear();
    out.face_plane.clear();
    for (FaceId f = 0; f < mesh_.face_count(); ++f) {
        if (!mesh_.alive(f)) continue;
        out.mesh.face.push_back(mesh_.face(f));
        out.face_plane.push_back(planes_.face_plane[f]);
    }
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v)
        out.mesh.position[v] = mesh_.position(v).cast<float>();
}

} // namespace

void unfold(PlaneMesh& mesh, const SimplifyParams& params)
{
    if (params.max_fold_error <= 0.0) return;
    const PlaneMesh before = mesh;
    Unfolder unfolder(before, params);
    const std::size_t changes = unfolder.run();
    unfolder.write(mesh);
    log_info(fmt::format("{} changes of edges and planes took folds out", changes));
}

} // namespace quoin
