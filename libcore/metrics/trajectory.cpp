#include "metrics/trajectory.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace quoin {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Rigid fit_rigid(std::span<const Vector3d> from, std::span<const Vector3d> onto)
{
    assert(from.size() == onto.size() && !from.empty());
    Vector3d center_from = Vector3d::Zero(), center_onto = Vector3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i)
        center_from += from[i], center_onto += onto[i];
    center_from /= static_cast<double>(from.size());
    center_onto /= static_cast<double>(from.size());
    Matrix3d covariance = Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i)
        covariance += (onto[i] - center_onto) * (from[i] - center_from).transpose();
    const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vector3d sign = Vector3d::Ones();
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;
    Rigid motion = Rigid::Identity();
    motion.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    motion.translation() = center_onto - motion.linear() * center_from;
    return motion;
}

TrajectoryError compare_trajectories(std::span<const Rigid> estimate, std::span<const Rigid> truth)
{
    std::vector<Vector3d> from, onto;
    for (std::size_t i = 0; i < estimate.size(); ++i) {
        from.push_back(estimate[i].translation());
        onto.push_back(truth[i].translation());
    }
    const Rigid truth_from_estimate = fit_rigid(from, onto);
    std::vector<double> distance;
    double square = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        distance.push_back((truth_from_estimate * from[i] - onto[i]).norm());
        square += distance.back() * distance.back();
    }
    TrajectoryError error;
    error.ate = std::sqrt(square / static_cast<double>(from.size()));
    std::nth_element(distance.begin(), distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2),
                     distance.end());
    error.ate_median = distance[distance.size() / 2];
    double position = 0.0, rotation = 0.0;
    for (std::size_t i = 1; i < estimate.size(); ++i) {
        const Rigid difference =
            (truth[i - 1].inverse() * truth[i]).inverse() * (estimate[i - 1].inverse() * estimate[i]);
        position += difference.translation().squaredNorm();
        rotation += std::pow(rotation_angle(difference.linear()), 2);
    }
    const double steps = std::max<double>(1.0, static_cast<double>(estimate.size()) - 1.0);
    error.relative_position = std::sqrt(position / steps);
    error.relative_rotation = std::sqrt(rotation / steps);
    return error;
}

} // namespace quoin
