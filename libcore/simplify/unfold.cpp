#include "simplify/unfold.h"

#include "base/log.h"
#include "base/parallel.h"
#include "simplify/collapse_mesh.h"
#include "simplify/fold_pieces.h"

#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace quoin {
namespace {

constexpr int kUnfoldPasses = 8; // few defects are left after two or three
// Sheets of a curtain are so thin that one lies within max_fold_error of the other: no more than a square of so many
// times that may go.
constexpr double kLargestLoss = 4.0;
constexpr std::size_t kLargestFan = 100; // [faces] that may move at once; all pairs of them are looked at
constexpr std::size_t kLookGrain = 256;  // [faces]

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

// Faces that may change, as they are, and those beside them.
struct Neighbourhood {
    std::vector<FaceId> face; // ascending
    Pieces before, outer;
    int defects = 0;

    // Can a change be better than the best one?
    bool may_gain(const std::optional<Change>& best) const { return defects > (best ? -best->defects - 1 : 0); }
};

class Unfolder {
public:
    Unfolder(const PlaneMesh& mesh, const SimplifyParams& params)
        : planes_(mesh), params_(params), mesh_(doubles(mesh.mesh.position), mesh.mesh.face),
          look_(mesh.mesh.face.size(), Look::Stirred)
    {
        piece_.reserve(look_.size());
        for (FaceId f = 0; f < look_.size(); ++f)
            piece_.push_back(piece(f));
    }

    std::size_t run()
    {
        std::size_t changes = 0;
        for (int pass = 0; pass < kUnfoldPasses; ++pass) {
            const std::size_t before = changes;
            find_defective();
            for (FaceId f = 0; f < mesh_.face_count(); ++f) {
                const Look look = std::exchange(look_[f], Look::Settled);
                if (look == Look::Settled || !mesh_.alive(f)) continue;
                for (bool bad = look == Look::Defective || is_defective(f); bad && improve(f);) {
                    ++changes;
                    bad = mesh_.alive(f) && is_defective(f);
                }
            }
            if (changes == before) break;
        }
        return changes;
    }

    void write(PlaneMesh& out) const;

private:
    // Settled: nothing has changed nearby since the face was looked at. Defective: nor since this was found.
    enum class Look : std::uint8_t { Settled, Stirred, Defective };

    Piece piece(FaceId f) const
    {
        const Face& t = mesh_.face(f);
        return {t, {mesh_.position(t[0]), mesh_.position(t[1]), mesh_.position(t[2])}, planes_.face_plane[f]};
    }
    std::vector<FaceId> around(std::initializer_list<VertexId> vertices) const;
    std::vector<FaceId> beside(const std::vector<FaceId>& inner) const;
    Pieces pieces(const std::vector<FaceId>& faces) const;
    Neighbourhood neighbourhood(std::vector<FaceId> faces) const;
    void find_defective();
    bool is_defective(FaceId f) const;
    bool improve(FaceId f);
    bool may_lose_faces_between(VertexId kept, VertexId gone);
    void try_contractions(VertexId a, VertexId b, std::optional<Change>& best);
    void try_contraction(Change change, const Neighbourhood& near, std::optional<Change>& best) const;
    void try_flip(FaceId f, VertexId a, VertexId b, std::optional<Change>& best) const;
    void try_other_planes(FaceId f, std::optional<Change>& best) const;
    void apply(const Change& change);
    void stir(VertexId v);
    void consider(Change change, const Neighbourhood& near, const Pieces& after, std::optional<Change>& best) const;
    bool open(VertexId v) const;

    PlaneMesh planes_; // its faces are as they were
    const SimplifyParams& params_;
    CollapseMesh mesh_;
    std::vector<Look> look_;   // F
    std::vector<Piece> piece_; // F; of faces that are alive
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
                if (g != f && mesh_.contains(g, b) && shares_edge(mesh_.face(f), mesh_.face(g)) &&
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
    result.reserve(faces.size());
    for (const FaceId f : faces)
        result.push_back(piece_[f]);
    return result;
}

Neighbourhood Unfolder::neighbourhood(std::vector<FaceId> faces) const
{
    Neighbourhood near{{}, pieces(faces), pieces(beside(faces)), 0};
    near.face = std::move(faces);
    near.defects = defects({near.before, near.outer}, planes_.plane);
    return near;
}

// Most faces are sound, which is found of all at once; the others are then looked at one by one.
void Unfolder::find_defective()
{
    parallel_for(
        look_.size(),
        [&](std::size_t i) {
            const auto f = static_cast<FaceId>(i);
            if (look_[f] == Look::Stirred)
                look_[f] = mesh_.alive(f) && is_defective(f) ? Look::Defective : Look::Settled;
        },
        kLookGrain);
}

bool Unfolder::is_defective(FaceId f) const { return neighbourhood({f}).defects > 0; }

// Applies the change of the face's or its neighbours' edges that gains most. Is there one?
bool Unfolder::improve(FaceId f)
{
    std::vector<FaceId> candidates = beside({f});
    candidates.push_back(f);
    std::optional<Change> best;
    std::set<std::pair<VertexId, VertexId>> tried;
    for (const FaceId g : candidates) {
        const Face face = mesh_.face(g);
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexId a = face[k], b = face[(k + 1) % 3];
            if (tried.insert(std::minmax(a, b)).second) try_contractions(a, b, best);
            try_flip(g, a, b, best);
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
        mesh_.for_each_face(w, [&](FaceId f) { look_[f] = Look::Stirred; });
}

void Unfolder::apply(const Change& change)
{
    std::vector<FaceId> changed(change.faces.begin(), change.faces.end());
    switch (change.kind) {
    case Change::Kind::Contraction:
        changed =
            mesh_.position(change.kept) == change.target ? around({change.gone}) : around({change.kept, change.gone});
        mesh_.move(change.kept, change.target);
        mesh_.contract(change.kept, change.gone);
        break;
    case Change::Kind::Flip:
        mesh_.flip(change.faces[0], change.faces[1], change.kept, change.gone);
        break;
    case Change::Kind::OtherPlane:
        planes_.face_plane[change.faces[0]] = change.plane;
    }
    for (const FaceId f : changed)
        if (mesh_.alive(f)) piece_[f] = piece(f);
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

// Of either end into the other, which stays, or of both into their middle.
void Unfolder::try_contractions(VertexId a, VertexId b, std::optional<Change>& best)
{
    std::array<FaceId, 2> faces{};
    const bool pinches = mesh_.faces_on_edge(a, b, faces) == 2 && open(a) && open(b);
    if (pinches || !mesh_.link_condition(a, b) || !may_lose_faces_between(a, b)) return;
    const Change into_a{.kept = a, .gone = b, .target = mesh_.position(a)},
        into_b{.kept = b, .gone = a, .target = mesh_.position(b)};
    if (auto both = around({a, b}); both.size() <= kLargestFan) {
        const Eigen::Vector3d middle = 0.5 * (mesh_.position(a) + mesh_.position(b));
        const Neighbourhood near = neighbourhood(std::move(both));
        try_contraction(into_a, near, best);
        try_contraction({.kept = a, .gone = b, .target = middle.cast<float>().cast<double>()}, near,
                        best); // as written
        try_contraction(into_b, near, best);
        return;
    }
    for (const Change& change : {into_a, into_b}) // the faces of the end that is kept stay
        if (auto inner = around({change.gone}); inner.size() <= kLargestFan)
            try_contraction(change, neighbourhood(std::move(inner)), best);
}

void Unfolder::try_contraction(Change change, const Neighbourhood& near, std::optional<Change>& best) const
{
    if (!near.may_gain(best)) return;
    Pieces after;
    after.reserve(near.face.size());
    for (const Piece& piece : near.before) {
        Face vertex = piece.vertex;
        Triangle corner = piece.corner;
        int moved = 0;
        for (std::size_t k = 0; k < 3; ++k)
            if (vertex[k] == change.kept || vertex[k] == change.gone) {
                vertex[k] = change.kept;
                corner[k] = change.target;
                ++moved;
            }
        if (moved < 2) after.emplace_back(vertex, corner, piece.plane);
    }
    consider(change, near, after, best);
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
    consider({.kind = Change::Kind::Flip, .kept = a, .gone = b, .faces = {f, g}},
             neighbourhood({std::min(f, g), std::max(f, g)}), after, best);
}

// A face with a single neighbour in its own plane leaves that in one piece.
void Unfolder::try_other_planes(FaceId f, std::optional<Change>& best) const
{
    const PlaneId plane = planes_.face_plane[f];
    const Neighbourhood near = neighbourhood({f});
    const auto neighbours = beside({f});
    if (std::count_if(neighbours.begin(), neighbours.end(), [&](FaceId g) { return planes_.face_plane[g] == plane; }) !=
        1)
        return;
    for (const FaceId g : neighbours) {
        if (planes_.face_plane[g] == plane) continue;
        Pieces after{piece_[f]};
        after[0].plane = planes_.face_plane[g];
        consider({.kind = Change::Kind::OtherPlane, .faces = {f, g}, .plane = planes_.face_plane[g]}, near, after,
                 best);
    }
}

// Distances cost most: they are found last, and no farther than they could still be the best.
void Unfolder::consider(Change change, const Neighbourhood& near, const Pieces& after,
                        std::optional<Change>& best) const
{
    const auto is_flat = [](const Piece& piece) { return piece.flat; };
    if (!near.may_gain(best) || after.empty() ||
        std::ranges::count_if(after, is_flat) > std::ranges::count_if(near.before, is_flat))
        return;
    const int enough = near.defects + (best ? best->defects : -1);
    change.defects = defects({after, near.outer}, planes_.plane, enough) - near.defects;
    if (change.defects > enough - near.defects) return;
    if (area_of(near.before) - area_of(after) > std::pow(kLargestLoss * params_.max_fold_error, 2)) return;
    const bool is_tie = best && change.defects == best->defects;
    const double most = is_tie ? best->error : params_.max_fold_error;
    change.error = farthest(near.before, {after, near.outer}, most);
    if (change.error > most) return;
    change.error = std::max(change.error, farthest(after, {near.before, {}}, most));
    if (change.error <= most && (!best || change.better_than(*best))) best = change;
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
