#include "simplify/snap.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "mesh/creases.h"
#include "mesh/flip_guard.h"

#include <cmath>
#include <numbers>

namespace quoin {
namespace {

constexpr std::size_t kGrain = 1 << 12;

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

// The one other plane behind two edges of a face; kNoPlane if there is none.
PlaneId plane_behind_ear(const PlaneMesh& mesh, const std::vector<std::uint32_t>& opposite, FaceId f)
{
    std::array<PlaneId, 3> behind{};
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t o = opposite[3 * f + k];
        behind[k] = o == kBorderEdge || o == kNonManifoldEdge ? kNoPlane : mesh.face_plane[o / 3];
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const PlaneId plane = behind[k];
        if (plane != kNoPlane && plane != mesh.face_plane[f] && plane == behind[(k + 1) % 3]) return plane;
    }
    return kNoPlane;
}

bool near_plane(const PlaneMesh& mesh, FaceId f, const Plane& plane, double distance)
{
    for (int k = 0; k < 3; ++k)
        if (std::abs(plane.signed_distance(corner(mesh.mesh, f, k))) > distance) return false;
    return true;
}

} // namespace

void trim_ears(PlaneMesh& mesh, const SimplifyParams& params)
{
    const auto opposite = opposite_half_edges(mesh.mesh);
    std::vector<std::size_t> size(mesh.plane.size(), 0);
    for (const PlaneId p : mesh.face_plane)
        ++size[p];
    // Every ear that goes over shortens the borders by an edge, so this ends.
    for (bool changed = true; changed;) {
        changed = false;
        for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
            const PlaneId plane = plane_behind_ear(mesh, opposite, f);
            if (plane == kNoPlane || size[mesh.face_plane[f]] < 2) continue;
            if (!near_plane(mesh, f, mesh.plane[plane], params.snap_distance)) continue;
            --size[mesh.face_plane[f]];
            ++size[plane];
            mesh.face_plane[f] = plane;
            changed = true;
        }
    }
}

void snap_to_planes(PlaneMesh& mesh, const SimplifyParams& params)
{
    const auto planes_at = vertex_planes(mesh.mesh, mesh.face_plane);
    const auto before = mesh.mesh.position;
    parallel_for(
        before.size(),
        [&](std::size_t v) {
            std::vector<Plane> planes;
            for (const PlaneId p : planes_at.of(static_cast<VertexId>(v)))
                planes.push_back(mesh.plane[p]);
            const Eigen::Vector3d p = before[v].cast<double>();
            const Eigen::Vector3d target = meet_planes(p, planes, radians(params.crease_angle)).point;
            if ((target - p).norm() <= params.snap_distance) mesh.mesh.position[v] = target.cast<float>();
        },
        kGrain);
    hold_back_flips(mesh, before, std::cos(radians(params.max_deviation)));
}

} // namespace quoin
