#include "alignment/state.h"

#include <cmath>

namespace quoin {

// p - (n . (p - c) + s) n
Eigen::Affine3d CenteredPlane::projection() const
{
    Eigen::Affine3d result;
    result.linear() = Eigen::Matrix3d::Identity() - normal * normal.transpose();
    result.translation() = -signed_distance(Vector3::Zero()) * normal;
    result.makeAffine();
    return result;
}

TangentBasis CenteredPlane::tangents() const
{
    TangentBasis basis;
    basis.col(0) = normal.unitOrthogonal();
    basis.col(1) = normal.cross(basis.col(0));
    return basis;
}

CenteredPlane CenteredPlane::moved(const Vector3& step) const
{
    return {(normal + tangents() * step.head<2>()).normalized(), offset + step.z(), center};
}

CenteredPlane centered(const Plane& plane, const Vector3& center)
{
    return {plane.normal, plane.signed_distance(center), center};
}

ColorCamera ColorCamera::moved(const CalibrationStep& step) const
{
    ColorCamera result = *this;
    result.color_from_depth = orthonormalized(exp_twist(step.head<6>()) * color_from_depth);
    result.camera.fx *= std::exp(step[6]);
    result.camera.fy *= std::exp(step[6]);
    result.camera.cx += step[7];
    result.camera.cy += step[8];
    return result;
}

} // namespace quoin
