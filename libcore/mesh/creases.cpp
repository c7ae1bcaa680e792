#include "mesh/creases.h"

#include "mesh/adjacency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace quoin {

namespace {

// Of two planes, by the directions between their normals and across.
PlaneMeeting meet_two(const Eigen::Vector3d& point, const Plane& a, const Plane& b, double least_value)
{
    const double cosine = a.normal.dot(b.normal);
    const Eigen::Vector3d other = cosine < 0.0 ? Eigen::Vector3d(-b.normal) : b.normal;
    const Eigen::Vector3d pull = -a.signed_distance(point) * a.normal - b.signed_distance(point) * b.normal;
    const double between = 1.0 + std::abs(cosine), across = 1.0 - std::abs(cosine); // eigenvalues of sum n n^T
    const Eigen::Vector3d u = a.normal + other, w = a.normal - other;               // of squared length 2 times these
    PlaneMeeting meeting{point + u.dot(pull) / (2.0 * between * between) * u, 1};
    if (across < least_value * between) return meeting;
    return {meeting.point + w.dot(pull) / (2.0 * across * across) * w, 2};
}

} // namespace

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
    if (planes.empty()) return {point, 0};
    if (planes.size() == 1) return {planes[0].project(point), 1};
    const double tangent = std::tan(0.5 * min_angle);
    const double least_value = std::max(tangent * tangent, 1e-9); // of the largest eigenvalue
    if (planes.size() == 2) return meet_two(point, planes[0], planes[1], least_value);
    Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    for (const auto& plane : planes) {
        normals += plane.normal * plane.normal.transpose();
        pull -= plane.signed_distance(point) * plane.normal;
    }
    PlaneMeeting meeting{point, 0};
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.compute(normals);
    for (int k = 2; k >= 0; --k) {
        const double value = eigen.eigenvalues()[k];
        if (value < least_value * eigen.eigenvalues()[2]) break;
        meeting.point += eigen.eigenvectors().col(k).dot(pull) / value * eigen.eigenvectors().col(k);
        ++meeting.rank;
    }
    return meeting;
}

} // namespace quoin
