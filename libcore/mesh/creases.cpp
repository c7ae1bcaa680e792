#include "mesh/creases.h"

#include "mesh/adjacency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace quoin {

VertexPlanes vertex_planes(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane)
{
    const auto around = vertex_faces(mesh);
    VertexPlanes planes;
    planes.first.assign(mesh.position.size() + 1, 0);
    planes.plane.reserve(mesh.position.size() + mesh.position.size() / 4);
    std::vector<PlaneId> here;
    for (VertexId v = 0; v < mesh.position.size(); ++v) {
        here.clear();
        for (const FaceId f : around.of(v))
            if (here.empty() || here.back() != face_plane[f]) here.push_back(face_plane[f]);
        std::sort(here.begin(), here.end());
        planes.plane.insert(planes.plane.end(), here.begin(), std::unique(here.begin(), here.end()));
        planes.first[v + 1] = static_cast<std::uint32_t>(planes.plane.size());
    }
    return planes;
}

PlaneMeeting meet_planes(const Eigen::Vector3d& point, std::span<const Plane> planes, double min_angle)
{
    Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    for (const auto& plane : planes) {
        normals += plane.normal * plane.normal.transpose();
        pull -= plane.signed_distance(point) * plane.normal;
    }
    PlaneMeeting meeting{point, 0};
    if (planes.empty()) return meeting;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.compute(normals);
    const double tangent = std::tan(0.5 * min_angle);
    for (int k = 2; k >= 0; --k) {
        const double value = eigen.eigenvalues()[k];
        if (value < std::max(tangent * tangent, 1e-9) * eigen.eigenvalues()[2]) break;
        meeting.point += eigen.eigenvectors().col(k).dot(pull) / value * eigen.eigenvectors().col(k);
        ++meeting.rank;
    }
    return meeting;
}

} // namespace quoin
