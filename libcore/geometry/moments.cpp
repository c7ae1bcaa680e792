#include "geometry/moments.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

Eigen::Matrix3d unpacked(const Eigen::Matrix<double, 6, 1>& s)
{
    Eigen::Matrix3d m;
    m << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
    return m;
}

} // namespace

Eigen::Matrix3d Moments::central() const
{
    if (area <= 0.0) return Eigen::Matrix3d::Zero();
    return unpacked(second) - first * first.transpose() / area;
}

Moments Moments::translated(const Eigen::Vector3d& shift) const
{
    Moments moved = *this;
    moved.first += area * shift;
    const Eigen::Matrix3d cross =
        first * shift.transpose() + shift * first.transpose() + area * shift * shift.transpose();
    moved.second[0] += cross(0, 0);
    moved.second[1] += cross(0, 1);
    moved.second[2] += cross(0, 2);
    moved.second[3] += cross(1, 1);
    moved.second[4] += cross(1, 2);
    moved.second[5] += cross(2, 2);
    return moved;
}

double smallest_eigenvalue(const Eigen::Matrix3d& matrix)
{
    const double p = matrix.trace() / 3.0;
    const Eigen::Matrix3d shifted = matrix - p * Eigen::Matrix3d::Identity();
    const double q = std::sqrt(shifted.squaredNorm() / 6.0);
    if (q <= 0.0) return p;
    const double r = std::clamp((shifted / q).determinant() / 2.0, -1.0, 1.0);
    return p + 2.0 * q * std::cos(std::acos(r) / 3.0 + 2.0 * std::numbers::pi / 3.0);
}

Plane fit_plane(const Moments& moments)
{
    const Eigen::Vector3d centroid = moments.centroid();
    Plane plane;
    if (moments.area > 0.0) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.central() / moments.area);
        if (solver.info() == Eigen::Success) plane.normal = solver.eigenvectors().col(0).normalized();
    }
    plane.offset = -plane.normal.dot(centroid);
    return plane;
}

double rms_to_fit(const Moments& moments)
{
    if (moments.area <= 0.0) return 0.0;
    return std::sqrt(std::max(0.0, smallest_eigenvalue(moments.central()) / moments.area));
}

double rms_to_plane(const Moments& moments, const Plane& plane)
{
    if (moments.area <= 0.0) return 0.0;
    const double spread = plane.normal.dot(moments.central() * plane.normal) / moments.area;
    const double distance = plane.signed_distance(moments.centroid());
    return std::sqrt(std::max(0.0, spread) + distance * distance);
}

} // namespace quoin
