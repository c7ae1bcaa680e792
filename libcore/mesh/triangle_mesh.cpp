#include "mesh/triangle_mesh.h"

#include <Eigen/Geometry>

namespace quoin {

Eigen::Vector3d area_vector(const TriangleMesh& mesh, FaceId f)
{
    const Eigen::Vector3d a = corner(mesh, f, 0);
    return (corner(mesh, f, 1) - a).cross(corner(mesh, f, 2) - a);
}

double face_area(const TriangleMesh& mesh, FaceId f) { return 0.5 * area_vector(mesh, f).norm(); }

Eigen::Vector3d face_normal(const TriangleMesh& mesh, FaceId f)
{
    const Eigen::Vector3d v = area_vector(mesh, f);
    const double length = v.norm();
    return length > 0.0 ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}

} // namespace quoin
