#include "simplify/collapse_mesh.h"

namespace quoin {

CollapseMesh::CollapseMesh(std::vector<Eigen::Vector3d> position, std::vector<Face> face)
    : position_(std::move(position)), face_(std::move(face)), first_(position_.size(), kEnd),
      next_(3 * face_.size(), kEnd), mark_(position_.size(), 0)
{
    for (auto f = static_cast<FaceId>(face_.size()); f-- > 0;)
        for (const VertexId v : face_[f])
            link(v, f);
}

void CollapseMesh::link(VertexId v, FaceId f)
{
    const auto& face = face_[f];
    const std::uint32_t c = 3 * f + static_cast<std::uint32_t>(std::find(face.begin(), face.end(), v) - face.begin());
    next_[c] = first_[v];
    first_[v] = c;
}

void CollapseMesh::unlink(VertexId v, FaceId f)
{
    std::uint32_t* at = &first_[v];
    while (*at / 3 != f)
        at = &next_[*at];
    *at = next_[*at];
}

bool CollapseMesh::adjacent(VertexId u, VertexId v) const
{
    for (std::uint32_t c = first_[u]; c != kEnd; c = next_[c])
        if (contains(c / 3, v)) return true;
    return false;
}

bool CollapseMesh::has_face(VertexId u, VertexId v, VertexId w) const
{
    for (std::uint32_t c = first_[u]; c != kEnd; c = next_[c])
        if (contains(c / 3, v) && contains(c / 3, w)) return true;
    return false;
}

void CollapseMesh::neighbours(VertexId v, std::vector<VertexId>& out)
{
    out.clear();
    const std::uint32_t stamp = fresh_stamp();
    for (std::uint32_t c = first_[v]; c != kEnd; c = next_[c]) {
        for (const VertexId w : face_[c / 3]) {
            if (w == v || mark_[w] == stamp) continue;
            mark_[w] = stamp;
            out.push_back(w);
        }
    }
}

bool CollapseMesh::has_fewer_faces(VertexId v, VertexId u) const
{
    std::uint32_t a = first_[v], b = first_[u];
    for (; a != kEnd && b != kEnd; b = next_[b])
        a = next_[a];
    return a == kEnd && b != kEnd;
}

int CollapseMesh::faces_on_edge(VertexId u, VertexId v, std::array<FaceId, 2>& faces) const
{
    int count = 0;
    if (has_fewer_faces(v, u)) std::swap(u, v); // flat zones have fans of thousands of faces
    for (std::uint32_t c = first_[u]; c != kEnd; c = next_[c]) {
        if (!contains(c / 3, v)) continue;
        if (count < 2) faces[static_cast<std::size_t>(count)] = c / 3;
        ++count;
    }
    return count;
}

bool CollapseMesh::link_condition(VertexId u, VertexId v)
{
    std::array<FaceId, 2> on_edge{};
    const int faces = faces_on_edge(u, v, on_edge);
    if (faces < 1 || faces > 2) return false;
    const std::uint32_t around_u = fresh_stamp(), common = around_u + 1;
    for (std::uint32_t c = first_[u]; c != kEnd; c = next_[c])
        for (const VertexId w : face_[c / 3])
            mark_[w] = around_u;
    mark_[u] = mark_[v] = 0;
    int shared = 0;
    for (std::uint32_t c = first_[v]; c != kEnd; c = next_[c]) {
        for (const VertexId w : face_[c / 3]) {
            if (mark_[w] != around_u) continue;
            mark_[w] = common;
            ++shared;
        }
    }
    if (shared != faces) return false;
    // A face of u whose other ends are both common neighbours falls on a face of v with them.
    if (faces < 2) return true;
    const VertexId x = third_vertex(on_edge[0], u, v), y = third_vertex(on_edge[1], u, v);
    return x != y && !(has_face(u, x, y) && has_face(v, x, y));
}

Eigen::Vector3d CollapseMesh::normal(FaceId f) const
{
    const auto& [a, b, c] = face_[f];
    return triangle_shape(position_[a], position_[b], position_[c]).normal;
}

Eigen::Vector3d CollapseMesh::normal_after(FaceId f, const Move& move) const
{
    const auto at = [&](VertexId w) -> const Eigen::Vector3d& {
        return w == move.u || w == move.v ? move.p : position_[w];
    };
    const auto& [a, b, c] = face_[f];
    return triangle_shape(at(a), at(b), at(c)).normal;
}

// Looks at the faces across the edge ab of face f, where a is not moved; b and the other end of the move count as one.
bool CollapseMesh::edge_folds(FaceId f, VertexId a, VertexId b, const Move& move, double folded_cosine) const
{
    const bool b_moves = b == move.u || b == move.v;
    for (std::uint32_t c = first_[a]; c != kEnd; c = next_[c]) {
        const FaceId g = c / 3;
        const bool dies = contains(g, move.u) && contains(g, move.v);
        const bool across = b_moves ? contains(g, move.u) || contains(g, move.v) : contains(g, b);
        if (g == f || dies || !across) continue;
        if (normal_after(f, move).dot(normal_after(g, move)) >= folded_cosine) continue;
        const bool were_neighbours = contains(g, b);
        if (!were_neighbours || normal(f).dot(normal(g)) >= folded_cosine) return true;
    }
    return false;
}

bool CollapseMesh::fan_folds(VertexId moved, const Move& move, double folded_cosine) const
{
    for (std::uint32_t c = first_[moved]; c != kEnd; c = next_[c]) {
        const FaceId f = c / 3;
        if (contains(f, move.u) && contains(f, move.v)) continue;
        const VertexId a = face_[f][(c % 3 + 1) % 3], b = face_[f][(c % 3 + 2) % 3];
        if (edge_folds(f, a, moved, move, folded_cosine) || edge_folds(f, b, moved, move, folded_cosine) ||
            edge_folds(f, a, b, move, folded_cosine))
            return true;
    }
    return false;
}

bool CollapseMesh::folds(VertexId u, VertexId v, const Eigen::Vector3d& p, double folded_cosine) const
{
    const Move move{u, v, p};
    return fan_folds(u, move, folded_cosine) || fan_folds(v, move, folded_cosine);
}

double CollapseMesh::least_facing(VertexId u, VertexId v, const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const
{
    double least = 1.0;
    for (const VertexId moved : {u, v})
        for (std::uint32_t c = first_[moved]; c != kEnd; c = next_[c]) {
            const Face& face = face_[c / 3];
            const VertexId a = face[(c % 3 + 1) % 3], b = face[(c % 3 + 2) % 3];
            const VertexId other = moved == u ? v : u;
            if (a == other || b == other) continue;
            least = std::min(least, triangle_shape(p, position_[a], position_[b]).normal.dot(normal));
        }
    return least;
}

void CollapseMesh::contract(VertexId kept, VertexId gone)
{
    for (std::uint32_t c = first_[gone], after = kEnd; c != kEnd; c = after) {
        after = next_[c];
        const FaceId f = c / 3;
        if (contains(f, kept)) {
            unlink(kept, f);
            unlink(third_vertex(f, kept, gone), f);
            face_[f] = {kEnd, kEnd, kEnd};
        } else {
            face_[f][c % 3] = kept;
            next_[c] = first_[kept];
            first_[kept] = c;
        }
    }
    first_[gone] = kEnd;
}

void CollapseMesh::flip(FaceId f, FaceId g, VertexId a, VertexId b)
{
    const VertexId c = third_vertex(f, a, b), d = third_vertex(g, a, b);
    for (const VertexId v : {a, b, c})
        unlink(v, f);
    for (const VertexId v : {a, b, d})
        unlink(v, g);
    face_[f] = {c, d, b};
    face_[g] = {d, c, a};
    for (const VertexId v : face_[f])
        link(v, f);
    for (const VertexId v : face_[g])
        link(v, g);
}

bool on_border(const CollapseMesh& mesh, const std::vector<PlaneId>& face_plane, VertexId u, VertexId v)
{
    std::array<FaceId, 2> faces{};
    return mesh.faces_on_edge(u, v, faces) != 2 || face_plane[faces[0]] != face_plane[faces[1]];
}

bool keeps_planes(const CollapseMesh& mesh, const std::vector<PlaneId>& face_plane, VertexId u, VertexId v)
{
    std::array<FaceId, 2> faces{};
    const int count = mesh.faces_on_edge(u, v, faces);
    for (int i = 0; i < count; ++i) {
        const VertexId w = mesh.third_vertex(faces[static_cast<std::size_t>(i)], u, v);
        if (on_border(mesh, face_plane, u, w) && on_border(mesh, face_plane, v, w)) return false;
    }
    return true;
}

std::vector<Eigen::Vector3d> doubles(const std::vector<Eigen::Vector3f>& position)
{
    std::vector<Eigen::Vector3d> p(position.size());
    for (std::size_t v = 0; v < p.size(); ++v)
        p[v] = position[v].cast<double>();
    return p;
}

} // namespace quoin
