// A triangle mesh in flat arrays whose edges can be contracted and flipped.
#pragma once

#include "mesh/plane_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace quoin {

struct ShapeLimits {
    double min_cosine = 0.0;     // between a face and its plane
    double turn_cosine = 0.0;    // between a face off its plane before and after a contraction
    double min_shape = 0.0;      // height over longest edge
    double folded_cosine = -0.5; // between faces on one edge
};

// The corners around each vertex form a singly linked list; corner c = 3 f + k. A dead face has no corner in any list.
class CollapseMesh {
public:
    static constexpr std::uint32_t kEnd = 0xffffffffu;

    CollapseMesh(std::vector<Eigen::Vector3d> position, std::vector<Face> face);

    const Eigen::Vector3d& position(VertexId v) const { return position_[v]; }
    const std::vector<Eigen::Vector3d>& positions() const { return position_; }
    void move(VertexId v, const Eigen::Vector3d& p) { position_[v] = p; }
    std::size_t vertex_count() const { return position_.size(); }
    std::size_t face_count() const { return face_.size(); } // with dead ones
    const Face& face(FaceId f) const { return face_[f]; }
    bool alive(FaceId f) const { return face_[f][0] != kEnd; }
    bool isolated(VertexId v) const { return first_[v] == kEnd; }

    template <class Visit>
    void for_each_face(VertexId v, const Visit& visit) const
    {
        for (std::uint32_t c = first_[v]; c != kEnd; c = next_[c])
            visit(static_cast<FaceId>(c / 3));
    }
    bool contains(FaceId f, VertexId v) const { return face_[f][0] == v || face_[f][1] == v || face_[f][2] == v; }
    bool adjacent(VertexId u, VertexId v) const;
    bool has_face(VertexId u, VertexId v, VertexId w) const;
    VertexId third_vertex(FaceId f, VertexId u, VertexId v) const
    {
        const auto& t = face_[f];
        return t[0] != u && t[0] != v ? t[0] : t[1] != u && t[1] != v ? t[1] : t[2];
    }
    // Distinct neighbours in the order of the corner list.
    void neighbours(VertexId v, std::vector<VertexId>& out);
    // Has v fewer faces than u? Costs the shorter list.
    bool has_fewer_faces(VertexId v, VertexId u) const;
    // Faces with both ends: their number, the first two in `faces`.
    int faces_on_edge(VertexId u, VertexId v, std::array<FaceId, 2>& faces) const;

    // Dey et al. 1999: contracting uv keeps the topology if u and v have no more neighbours in common than the edge has
    // faces, and no face would come to lie on another.
    bool link_condition(VertexId u, VertexId v);

    // Would every face of u or v stay within the limits, or be no worse than now, if both moved to p? plane_of(f) is
    // its plane.
    template <class PlaneOf>
    bool keeps_shape(VertexId u, VertexId v, const Eigen::Vector3d& p, const ShapeLimits& limits,
                     const PlaneOf& plane_of) const
    {
        return fan_keeps_shape(u, v, p, limits, plane_of) && fan_keeps_shape(v, u, p, limits, plane_of);
    }
    template <class PlaneOf>
    bool fan_keeps_shape(VertexId moved, VertexId other, const Eigen::Vector3d& p, const ShapeLimits& limits,
                         const PlaneOf& plane_of) const;

    // Would a face of u or v come to lie folded on a neighbour, the cosine of their normals below `folded_cosine`, if
    // both moved to p, though it does not now?
    bool folds(VertexId u, VertexId v, const Eigen::Vector3d& p, double folded_cosine) const;

    // Cosine of the largest angle between `normal` and a face of u or v, if both moved to p.
    double least_facing(VertexId u, VertexId v, const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const;

    // Moves all faces of `gone` to `kept`; faces with both die.
    void contract(VertexId kept, VertexId gone);

    // The edge ab of faces f (a,b,c) and g (b,a,d) becomes cd: f = (c,d,b), g = (d,c,a).
    void flip(FaceId f, FaceId g, VertexId a, VertexId b);

private:
    struct Move { // u and v to p
        VertexId u = 0, v = 0;
        const Eigen::Vector3d& p;
    };
    Eigen::Vector3d normal(FaceId f) const;
    Eigen::Vector3d normal_after(FaceId f, const Move& move) const;
    bool fan_folds(VertexId moved, const Move& move, double folded_cosine) const;
    bool edge_folds(FaceId f, VertexId a, VertexId b, const Move& move, double folded_cosine) const;
    void unlink(VertexId v, FaceId f);
    void link(VertexId v, FaceId f);
    std::uint32_t fresh_stamp() { return stamp_ += 2; }

    std::vector<Eigen::Vector3d> position_;
    std::vector<Face> face_;
    std::vector<std::uint32_t> first_; // V
    std::vector<std::uint32_t> next_;  // 3 F
    std::vector<std::uint32_t> mark_;  // V
    std::uint32_t stamp_ = 0;
};

// Is the edge uv a border of the mesh, or between two planes? face_plane has one a face.
bool on_border(const CollapseMesh& mesh, const std::vector<PlaneId>& face_plane, VertexId u, VertexId v);

// Do planes stay in one piece, and keep a face, when uv is contracted? A face that dies between two other borders would
// be the last of its plane, or the bridge between two parts of it.
bool keeps_planes(const CollapseMesh& mesh, const std::vector<PlaneId>& face_plane, VertexId u, VertexId v);

std::vector<Eigen::Vector3d> doubles(const std::vector<Eigen::Vector3f>& position);

// Unit normal (zero without area) and height over longest edge of a triangle.
struct TriangleShape {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double shape = 0.0;
};
inline TriangleShape triangle_shape(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c)
{
    const Eigen::Vector3d ab = b - a, ac = c - a, n = ab.cross(ac);
    const double length = n.norm();
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
    if (!(length > 0.0)) return {};
    return {n / length, length / longest};
}

// Is the face `now` close to its plane, or does it follow the face it `was` where that one is not? Never over to the
// other side.
inline bool acceptable(const TriangleShape& now, const TriangleShape& was, const Plane& plane,
                       const ShapeLimits& limits)
{
    if (now.shape <= 0.0 || now.shape < std::min(limits.min_shape, was.shape)) return false;
    const double facing = now.normal.dot(plane.normal);
    if (facing >= limits.min_cosine) return true;
    return now.normal.dot(was.normal) >= limits.turn_cosine && facing >= std::min(0.0, was.normal.dot(plane.normal));
}

template <class PlaneOf>
bool CollapseMesh::fan_keeps_shape(VertexId moved, VertexId other, const Eigen::Vector3d& p, const ShapeLimits& limits,
                                   const PlaneOf& plane_of) const
{
    for (std::uint32_t c = first_[moved]; c != kEnd; c = next_[c]) {
        const FaceId f = c / 3;
        if (contains(f, other)) continue;
        const std::uint32_t k = c % 3;
        const Eigen::Vector3d &a = position_[face_[f][(k + 1) % 3]], &b = position_[face_[f][(k + 2) % 3]];
        const TriangleShape now = triangle_shape(p, a, b);
        const Plane& plane = plane_of(f);
        if (now.shape > 0.0 && now.shape >= limits.min_shape && now.normal.dot(plane.normal) >= limits.min_cosine)
            continue; // whatever it was
        if (!acceptable(now, triangle_shape(position_[moved], a, b), plane, limits)) return false;
    }
    return true;
}

} // namespace quoin
