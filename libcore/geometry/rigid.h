// Rigid transforms, named a_from_b so that products read as a chain: p_camera = camera_from_world * p_world.
#pragma once

#include <Eigen/Geometry>

namespace quoin {

using Rigid = Eigen::Isometry3d;
using Twist = Eigen::Matrix<double, 6, 1>; // (omega [rad], v [m])

inline Eigen::Matrix3d skew(const Eigen::Vector3d& v)
{
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

// Exponential map of se(3) (Rodrigues) and its inverse.
Rigid exp_twist(const Twist& twist);
Twist log_twist(const Rigid& transform);

// The nearest rotation, so that products of many updates stay rigid.
Rigid orthonormalized(const Rigid& transform);

// Finite, orthonormal within tolerance, determinant +1.
bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance = 1e-3);

// Rotation angle [rad].
double rotation_angle(const Eigen::Matrix3d& rotation);

} // namespace quoin
