#include "mesh/plane_parts.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace quoin {
namespace {

bool looks_away(const TriangleMesh& mesh, FaceId f, const Plane& plane)
{
    return area_vector(mesh, f).dot(plane.normal) < 0.0;
}

Moments moments_of(const PlaneMesh& mesh, const std::vector<FaceId>& faces)
{
    Moments moments;
    for (const FaceId f : faces)
        moments += triangle_moments(corner(mesh.mesh, f, 0), corner(mesh.mesh, f, 1), corner(mesh.mesh, f, 2));
    return moments;
}

// Least squares, facing the side that the faces face: one of them at least does not look away.
Plane plane_through(const PlaneMesh& mesh, const std::vector<FaceId>& faces)
{
    Eigen::Vector3d facing = Eigen::Vector3d::Zero();
    for (const FaceId f : faces)
        facing += area_vector(mesh.mesh, f);
    const Plane plane = fit_plane(moments_of(mesh, faces));
    return plane.normal.dot(facing) < 0.0 ? plane.flipped() : plane;
}

class PartSeparator {
public:
    PartSeparator(PlaneMesh& mesh, double distance, PlaneParts kind)
        : mesh_(mesh), distance_(distance), kind_(kind), opposite_(opposite_half_edges(mesh.mesh))
    {
    }

    // Moves parts that do not keep their plane. Are there planes that may have parts to move now?
    bool run()
    {
        find_parts();
        find_keepers();
        std::map<FaceId, std::vector<FaceId>> moved; // by root
        for (FaceId f = 0; f < root_.size(); ++f)
            if (root_[f] != keeper_[mesh_.face_plane[f]]) moved[root_[f]].push_back(f);
        turn_keepers();
        const auto face_plane = mesh_.face_plane;
        for (const auto& [_, part] : moved) {
            const PlaneId plane = plane_for(part, face_plane);
            for (const FaceId f : part)
                mesh_.face_plane[f] = plane;
        }
        return fitted_;
    }

private:
    bool away(FaceId f) const
    {
        return kind_ == PlaneParts::OneSided && looks_away(mesh_.mesh, f, mesh_.plane[mesh_.face_plane[f]]);
    }
    void find_parts();
    void find_keepers();
    void turn_keepers();
    PlaneId plane_for(const std::vector<FaceId>& part, const std::vector<PlaneId>& face_plane);

    PlaneMesh& mesh_;
    const double distance_;
    const PlaneParts kind_;
    const std::vector<std::uint32_t> opposite_;
    std::vector<FaceId> root_;   // of the part of every face
    std::vector<FaceId> keeper_; // of every plane the root of the part that keeps it
    bool fitted_ = false;        // is there a plane that a part is fitted by?
};

void PartSeparator::find_parts()
{
    UnionFind parts(mesh_.mesh.face.size());
    for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
        if (!is_half_edge(opposite_[h])) continue;
        const FaceId f = h / 3, g = opposite_[h] / 3;
        if (mesh_.face_plane[f] != mesh_.face_plane[g] || away(f) != away(g)) continue;
        const std::uint32_t a = parts.find(f), b = parts.find(g);
        if (a != b) parts.join(std::min(a, b), std::max(a, b));
    }
    root_.resize(mesh_.mesh.face.size());
    for (FaceId f = 0; f < root_.size(); ++f)
        root_[f] = parts.find(f);
}

void PartSeparator::find_keepers()
{
    std::vector<double> area(root_.size(), 0.0); // of a part, at its root
    for (FaceId f = 0; f < root_.size(); ++f)
        area[root_[f]] += face_area(mesh_.mesh, f);
    const auto rank = [&](FaceId root) { return std::tuple(!away(root), area[root]); };
    keeper_.assign(mesh_.plane.size(), 0);
    std::vector<std::uint8_t> kept(mesh_.plane.size(), 0);
    for (FaceId f = 0; f < root_.size(); ++f) {
        const PlaneId p = mesh_.face_plane[f];
        if (root_[f] != f || (kept[p] != 0 && rank(f) <= rank(keeper_[p]))) continue;
        keeper_[p] = f;
        kept[p] = 1;
    }
}

void PartSeparator::turn_keepers()
{
    std::map<PlaneId, std::vector<FaceId>> turned;
    for (FaceId f = 0; f < root_.size(); ++f)
        if (root_[f] == keeper_[mesh_.face_plane[f]] && away(f)) turned[mesh_.face_plane[f]].push_back(f);
    for (const auto& [plane, faces] : turned) {
        mesh_.plane[plane] = plane_through(mesh_, faces);
        fitted_ = true;
    }
}

// Planes count by their borders with parts that keep them, as `face_plane` has it from before anything moved.
PlaneId PartSeparator::plane_for(const std::vector<FaceId>& part, const std::vector<PlaneId>& face_plane)
{
    const PlaneId own = face_plane[part[0]];
    const auto plane_behind = [&](FaceId f) -> std::optional<PlaneId> {
        const PlaneId p = face_plane[f];
        return p != own && root_[f] == keeper_[p] ? std::optional(p) : std::nullopt;
    };
    if (const auto beside = plane_beside(mesh_, opposite_, part, distance_, plane_behind)) return *beside;
    const bool fitted = kind_ == PlaneParts::OneSided && !explains(mesh_.mesh, mesh_.plane[own], part, distance_);
    mesh_.plane.push_back(fitted ? plane_through(mesh_, part) : Plane(mesh_.plane[own]));
    mesh_.moments.push_back(moments_of(mesh_, part));
    fitted_ = fitted_ || fitted;
    return static_cast<PlaneId>(mesh_.plane.size() - 1);
}

} // namespace

bool explains(const TriangleMesh& mesh, const Plane& plane, const std::vector<FaceId>& faces, double distance)
{
    return std::ranges::all_of(faces, [&](FaceId f) {
        for (int k = 0; k < 3; ++k)
            if (std::abs(plane.signed_distance(corner(mesh, f, k))) > distance) return false;
        return !looks_away(mesh, f, plane);
    });
}

std::optional<PlaneId> plane_beside(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite,
                                    const std::vector<FaceId>& faces, double distance,
                                    const std::function<std::optional<PlaneId>(FaceId)>& plane_behind)
{
    std::map<PlaneId, double> border;
    for (const FaceId f : faces)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t o = opposite[3 * f + k];
            const auto plane = is_half_edge(o) ? plane_behind(o / 3) : std::nullopt;
            if (!plane) continue;
            border[*plane] +=
                (corner(mesh.mesh, f, static_cast<int>((k + 1) % 3)) - corner(mesh.mesh, f, static_cast<int>(k)))
                    .norm();
        }
    std::optional<PlaneId> best;
    for (const auto& [plane, length] : border)
        if (explains(mesh.mesh, mesh.plane[plane], faces, distance) && (!best || length > border[*best])) best = plane;
    return best;
}

// A plane that is fitted to a part faces some of it, so that each turn moves fewer faces.
void separate_parts(PlaneMesh& mesh, double distance, PlaneParts kind)
{
    while (PartSeparator(mesh, distance, kind).run())
        ;
}

} // namespace quoin
