#include "geometry/rigid.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

constexpr double kSmallAngle = 1e-2; // [rad]

} // namespace

Rigid exp_twist(const Twist& twist)
{
    const Eigen::Vector3d omega = twist.head<3>();
    const double angle = omega.norm();
    const Eigen::Matrix3d W = skew(omega);
    // sin(t)/t, (1-cos t)/t^2, (t-sin t)/t^3: by their series where the closed forms cancel
    const double t2 = angle * angle;
    double a = 1.0 - t2 / 6.0 + t2 * t2 / 120.0, b = 0.5 - t2 / 24.0 + t2 * t2 / 720.0,
           c = 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0;
    if (angle > kSmallAngle) {
        a = std::sin(angle) / angle;
        b = (1.0 - std::cos(angle)) / (angle * angle);
        c = (1.0 - a) / (angle * angle);
    }
    Rigid transform = Rigid::Identity();
    transform.linear() = Eigen::Matrix3d::Identity() + a * W + b * W * W;
    transform.translation() = (Eigen::Matrix3d::Identity() + b * W + c * W * W) * twist.tail<3>();
    return transform;
}

Twist log_twist(const Rigid& transform)
{
    const Eigen::AngleAxisd rotation(transform.linear());
    const Eigen::Vector3d omega = rotation.angle() * rotation.axis();
    const double angle = rotation.angle();
    const Eigen::Matrix3d W = skew(omega);
    double d = 1.0 / 12.0 + angle * angle / 720.0 + angle * angle * angle * angle / 30240.0;
    if (angle > kSmallAngle) d = (1.0 - angle * std::sin(angle) / (2.0 * (1.0 - std::cos(angle)))) / (angle * angle);
    Twist twist;
    twist.head<3>() = omega;
    twist.tail<3>() = (Eigen::Matrix3d::Identity() - 0.5 * W + d * W * W) * transform.translation();
    return twist;
}

Rigid orthonormalized(const Rigid& transform)
{
    Rigid result = transform;
    result.linear() = Eigen::Quaterniond(transform.linear()).normalized().toRotationMatrix();
    return result;
}

bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance)
{
    if (!matrix.allFinite()) return false;
    const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
    const bool bottom = (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < tolerance;
    return bottom && (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < tolerance && R.determinant() > 0.0;
}

double rotation_angle(const Eigen::Matrix3d& rotation)
{
    const Eigen::Quaterniond q(rotation);
    return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

} // namespace quoin
