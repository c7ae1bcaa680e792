#include "alignment/plane_flow.h"

namespace quoin {
namespace {

constexpr double kMinDistance = 1e-4; // [m] of the camera to a plane whose picture can move

}

// With x_color = R x_depth + t, the turn omega and shift v of the depth camera are R omega and R v + t x (R omega) of
// the colour camera.
Eigen::Matrix<double, 6, 6> CameraFlow::by_pose() const
{
    const Eigen::Matrix3d R = color_from_depth.linear();
    Eigen::Matrix<double, 6, 6> B = Eigen::Matrix<double, 6, 6>::Zero();
    B.topLeftCorner<3, 3>() = B.bottomRightCorner<3, 3>() = R;
    B.bottomLeftCorner<3, 3>() = skew(color_from_depth.translation()) * R;
    return B;
}

CameraStep CameraFlow::step(const Twist& pose, const CalibrationStep& calibration) const
{
    const Vector3 omega = color_from_depth.linear() * pose.head<3>(), v = color_from_depth.linear() * pose.tail<3>();
    CameraStep result = calibration;
    result.head<3>() += omega;
    result.segment<3>(3) += v + color_from_depth.translation().cross(omega);
    result[7] /= fx;
    result[8] /= fy;
    return result;
}

Twist CameraFlow::pose_gradient(const CameraStep& gradient) const
{
    const Eigen::Matrix3d R_t = color_from_depth.linear().transpose();
    const Vector3 by_omega = gradient.head<3>(), by_v = gradient.segment<3>(3);
    return twist(R_t * (by_omega - color_from_depth.translation().cross(by_v)), R_t * by_v);
}

CalibrationStep CameraFlow::calibration_gradient(const CameraStep& gradient) const
{
    CalibrationStep result = gradient;
    result[7] /= fx;
    result[8] /= fy;
    return result;
}

CameraFlow camera_flow(const ColorCamera& color) { return {color.color_from_depth, color.camera.fx, color.camera.fy}; }

// A step (alpha, s) moves the point X along the normal n by -((X - c) . a + s) with a = tangents alpha.
Eigen::Matrix3d PlaneFlow::flow(const CameraStep& camera, const Vector3& plane) const
{
    const Vector3 v = camera.segment<3>(3), a = tangents * plane.head<2>();
    Eigen::Matrix3d F = skew(camera.head<3>());
    F.noalias() += v * inverse_depth.transpose();
    F.noalias() -= normal * (a + (plane.z() - center.dot(a)) * inverse_depth).transpose();
    F(0, 0) += camera[6];
    F(1, 1) += camera[6];
    F(0, 2) += camera[7];
    F(1, 2) += camera[8];
    return F;
}

CameraStep PlaneFlow::camera_gradient(const Eigen::Matrix3d& S) const
{
    CameraStep result;
    result.head<3>() = Vector3(S(2, 1) - S(1, 2), S(0, 2) - S(2, 0), S(1, 0) - S(0, 1));
    result.segment<3>(3) = S * inverse_depth;
    result.tail<3>() = Vector3(S(0, 0) + S(1, 1), S(0, 2), S(1, 2));
    return result;
}

Vector3 PlaneFlow::plane_gradient(const Eigen::Matrix3d& S) const
{
    const Vector3 by_a = -S.transpose() * normal;
    Vector3 result;
    result.z() = by_a.dot(inverse_depth);
    result.head<2>() = tangents.transpose() * (by_a - result.z() * center);
    return result;
}

// normal . (X - center) + offset = 0, so that 1/Z = normal . r / (normal . center - offset).
PlaneFlow plane_flow(const Rigid& color_from_world, const CenteredPlane& plane)
{
    PlaneFlow result;
    const Vector3 normal = color_from_world.linear() * plane.normal, center = color_from_world * plane.center;
    const double distance = normal.dot(center) - plane.offset;
    if (std::abs(distance) < kMinDistance) return result;
    result.inverse_depth = normal / distance;
    result.normal = normal;
    result.center = center;
    result.tangents = color_from_world.linear() * plane.tangents();
    return result;
}

} // namespace quoin
