// Where planes meet: the target of vertices on creases and in corners.
#pragma once

#include "mesh/plane_mesh.h"

#include <span>

namespace quoin {

// Distinct planes of the faces around every vertex, ascending: planes of v are plane[first[v]] .. plane[first[v+1]-1].
struct VertexPlanes {
    std::vector<std::uint32_t> first; // V + 1
    std::vector<PlaneId> plane;
    std::span<const PlaneId> of(VertexId v) const { return {plane.data() + first[v], first[v + 1] - first[v]}; }
};
VertexPlanes vertex_planes(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane);

// The point nearest to another one on what several planes have in common.
struct PlaneMeeting {
    Eigen::Vector3d point; // world [m]
    int rank = 0;          // 0: no planes; 1: on a plane; 2: on a line; 3: in a corner
};

// Two planes at less than `min_angle` [rad] count as the one between them, for the line in which they meet is far away
// and unstable: directions in which sum n n^T falls below tan^2(min_angle / 2) of its largest eigenvalue are left free.
PlaneMeeting meet_planes(const Eigen::Vector3d& point, std::span<const Plane> planes, double min_angle);

} // namespace quoin
