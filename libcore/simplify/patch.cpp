#include "simplify/patch.h"

#include <optional>

namespace quoin {
namespace {

// Cotangent of the angle at a in the triangle a b c.
double cotangent(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c)
{
    const Eigen::Vector3d u = b - a, v = c - a;
    return u.dot(v) / std::max(u.cross(v).norm(), 1e-300);
}

// The other face on the edge from a to b, if it is one, runs it the other way and the edge is inside the plane.
std::optional<FaceId> face_across(const CollapseMesh& mesh, VertexId a, VertexId b)
{
    std::array<FaceId, 2> faces{};
    if (mesh.faces_on_edge(a, b, faces) != 2) return {};
    const auto runs = [&](FaceId f) {
        const auto& t = mesh.face(f);
        return (t[0] == b && t[1] == a) || (t[1] == b && t[2] == a) || (t[2] == b && t[0] == a);
    };
    if (runs(faces[0]) == runs(faces[1])) return {};
    return runs(faces[0]) ? faces[0] : faces[1];
}

bool try_flip(Patch& patch, FaceId f, std::size_t k, const ShapeLimits& limits)
{
    auto& mesh = patch.mesh;
    const VertexId a = mesh.face(f)[k], b = mesh.face(f)[(k + 1) % 3], c = mesh.face(f)[(k + 2) % 3];
    const auto g = face_across(mesh, a, b);
    if (!g) return false;
    const VertexId d = mesh.third_vertex(*g, a, b);
    const auto &pa = mesh.position(a), &pb = mesh.position(b), &pc = mesh.position(c), &pd = mesh.position(d);
    constexpr double kFlat = -1e-9; // or cocircular quads flip for ever
    if (cotangent(pc, pa, pb) + cotangent(pd, pb, pa) >= kFlat) return false;
    const auto was_f = triangle_shape(pa, pb, pc), was_g = triangle_shape(pb, pa, pd);
    const auto& worse = was_f.normal.dot(patch.plane.normal) < was_g.normal.dot(patch.plane.normal) ? was_f : was_g;
    const TriangleShape was{worse.normal, std::min(was_f.shape, was_g.shape)};
    if (!acceptable(triangle_shape(pc, pd, pb), was, patch.plane, limits)) return false;
    if (!acceptable(triangle_shape(pd, pc, pa), was, patch.plane, limits)) return false;
    if (mesh.adjacent(c, d) || !patch.may_join(c, d) || !patch.inside(a, b)) return false;
    mesh.flip(f, *g, a, b);
    return true;
}

} // namespace

PatchIndex::PatchIndex(const PlaneMesh& mesh)
    : mesh_(mesh), chords_(mesh), faces_(group_items(mesh.face_plane, mesh.plane.size()))
{
    std::vector<PlaneId> plane_of(mesh.mesh.position.size(), kNoPlane);
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f)
        for (const VertexId v : mesh.mesh.face[f])
            if (mesh.vertex_class[v] == VertexClass::Inner) plane_of[v] = mesh.face_plane[f];
    inner_ = group_items(plane_of, mesh.plane.size());
    rank_.resize(plane_of.size(), 0);
    for (PlaneId p = 0; p < mesh.plane.size(); ++p)
        for (std::uint32_t i = 0; i < inner_.of(p).size(); ++i)
            rank_[inner_.of(p)[i]] = i;
}

Patch PatchIndex::extract(PlaneId p) const
{
    const std::span<const FaceId> faces = faces_.of(p);
    const auto is_inner = [&](VertexId v) { return mesh_.vertex_class[v] == VertexClass::Inner; };
    std::vector<VertexId> global(inner_.of(p).begin(), inner_.of(p).end());
    const auto inner_count = static_cast<VertexId>(global.size());
    for (const FaceId f : faces)
        for (const VertexId v : mesh_.mesh.face[f])
            if (!is_inner(v)) global.push_back(v);
    std::sort(global.begin() + inner_count, global.end());
    global.erase(std::unique(global.begin() + inner_count, global.end()), global.end());

    const auto local = [&](VertexId v) {
        if (is_inner(v)) return rank_[v];
        return static_cast<VertexId>(std::lower_bound(global.begin() + inner_count, global.end(), v) - global.begin());
    };
    const Eigen::Vector3d origin =
        global.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(mesh_.mesh.position[global[0]].cast<double>());
    std::vector<Eigen::Vector3d> position(global.size());
    for (std::size_t v = 0; v < global.size(); ++v)
        position[v] = mesh_.mesh.position[global[v]].cast<double>() - origin;
    std::vector<Face> face(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
            face[f][k] = local(mesh_.mesh.face[faces[f]][k]);
    const Plane plane{mesh_.plane[p].normal, mesh_.plane[p].signed_distance(origin)};
    return {p,       plane, origin, inner_count, std::move(global), CollapseMesh(std::move(position), std::move(face)),
            &chords_};
}

std::size_t flip_to_delaunay(Patch& patch, const ShapeLimits& limits, int sweeps)
{
    std::size_t flips = 0;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        const std::size_t before = flips;
        for (FaceId f = 0; f < patch.mesh.face_count(); ++f)
            for (std::size_t k = 0; k < 3 && patch.mesh.alive(f); ++k)
                flips += try_flip(patch, f, k, limits) ? 1 : 0;
        if (flips == before) break;
    }
    return flips;
}

} // namespace quoin
