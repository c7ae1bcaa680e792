#include "simplify/snap.h"

#include "base/parallel.h"
#include "geometry/radix_sort.h"
#include "geometry/units.h"
#include "mesh/adjacency.h"
#include "mesh/creases.h"
#include "mesh/flip_guard.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace quoin {
namespace {

constexpr std::size_t kSnapGrain = 1 << 12;

// The one other plane behind two edges of a face; kNoPlane if there is none.
PlaneId plane_behind_ear(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite, FaceId f)
{
    std::array<PlaneId, 3> behind{};
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t o = opposite[3 * f + k];
        behind[k] = is_half_edge(o) ? mesh.face_plane[o / 3] : kNoPlane;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const PlaneId plane = behind[k];
        if (plane != kNoPlane && plane != mesh.face_plane[f] && plane == behind[(k + 1) % 3]) return plane;
    }
    return kNoPlane;
}

bool explained_by(const PlaneMesh& mesh, FaceId f, const Plane& plane, double distance)
{
    if (area_vector(mesh.mesh, f).dot(plane.normal) < 0.0) return false;
    for (int k = 0; k < 3; ++k)
        if (std::abs(plane.signed_distance(corner(mesh.mesh, f, k))) > distance) return false;
    return true;
}

void snap(PlaneMesh& mesh, VertexId v, std::span<const PlaneId> ids, const SimplifyParams& params)
{
    std::vector<Plane> planes;
    for (const PlaneId p : ids)
        planes.push_back(mesh.plane[p]);
    const Eigen::Vector3d p = mesh.mesh.position[v].cast<double>();
    const Eigen::Vector3d target = meet_planes(p, planes, radians(params.crease_angle)).point;
    if ((target - p).norm() <= params.snap_distance) mesh.mesh.position[v] = target.cast<float>();
}

struct PlaneUse {
    VertexId vertex = 0;
    PlaneId plane = 0;
    auto operator<=>(const PlaneUse&) const = default;
};

// Planes at the vertices of curves and of the faces of `part`, sorted, each once.
std::vector<PlaneUse> plane_uses(const Curves& curves, const PlaneMesh& part)
{
    std::vector<Keyed> keys;
    const auto add = [&](VertexId v, PlaneId p) { keys.push_back({(std::uint64_t{v} << 32) | p, 0}); };
    for (std::uint32_t s = 0; s < curves.size(); ++s)
        for (const PlaneId p : curves.curve[curves.curve_of[s]].planes)
            if (p != kNoPlane) add(curves.vertex[s], p);
    for (FaceId f = 0; f < part.mesh.face.size(); ++f)
        for (const VertexId v : part.mesh.face[f])
            add(v, part.face_plane[f]);
    radix_sort(keys);
    std::vector<PlaneUse> uses;
    for (const auto& [key, item] : keys) {
        const PlaneUse use{static_cast<VertexId>(key >> 32), static_cast<PlaneId>(key)};
        if (uses.empty() || uses.back() != use) uses.push_back(use);
    }
    return uses;
}

} // namespace

void trim_ears(PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite, const SimplifyParams& params)
{
    std::vector<std::size_t> size(mesh.plane.size(), 0);
    for (const PlaneId p : mesh.face_plane)
        ++size[p];
    const auto may_be_ears = parallel_select<FaceId>(mesh.mesh.face.size(), kSnapGrain, [&](std::size_t f) {
        return plane_behind_ear(mesh, opposite, static_cast<FaceId>(f)) != kNoPlane;
    });
    std::set<FaceId> stirred(may_be_ears.begin(), may_be_ears.end());
    // Every ear that goes over shortens the borders by an edge, so this ends. From the first face to the last, and
    // again.
    for (auto next = stirred.begin(); !stirred.empty();) {
        const FaceId f = *next;
        stirred.erase(next);
        const PlaneId plane = plane_behind_ear(mesh, opposite, f);
        if (plane != kNoPlane && size[mesh.face_plane[f]] > 1 &&
            explained_by(mesh, f, mesh.plane[plane], params.snap_distance)) {
            --size[mesh.face_plane[f]];
            ++size[plane];
            mesh.face_plane[f] = plane;
            for (std::uint32_t k = 0; k < 3; ++k)
                if (const std::uint32_t o = opposite[3 * f + k]; is_half_edge(o)) stirred.insert(o / 3);
        }
        next = stirred.upper_bound(f);
        if (next == stirred.end()) next = stirred.begin();
    }
}

void snap_to_planes(PlaneMesh& mesh, const SimplifyParams& params)
{
    const auto planes_at = vertex_planes(mesh.mesh, mesh.face_plane);
    const auto before = mesh.mesh.position;
    parallel_for(
        before.size(),
        [&](std::size_t v) { snap(mesh, static_cast<VertexId>(v), planes_at.of(static_cast<VertexId>(v)), params); },
        kSnapGrain);
    hold_back_flips(mesh, before, {.min_cosine = std::cos(radians(params.max_deviation))});
}

void snap_curves(const Curves& curves, PlaneMesh& part, const SimplifyParams& params)
{
    if (params.snap_distance <= 0.0) return;
    const auto uses = plane_uses(curves, part);
    const auto before = part.mesh.position;
    parallel_for(
        uses.size(),
        [&](std::size_t i) {
            const VertexId v = uses[i].vertex;
            if (i > 0 && uses[i - 1].vertex == v) return; // its first use stands for all
            std::vector<PlaneId> planes;
            for (; i < uses.size() && uses[i].vertex == v; ++i)
                planes.push_back(uses[i].plane);
            snap(part, v, planes, params);
        },
        kSnapGrain);
    if (!part.mesh.face.empty()) hold_back_flips(part, before, {.min_cosine = std::cos(radians(params.max_deviation))});
}

} // namespace quoin
