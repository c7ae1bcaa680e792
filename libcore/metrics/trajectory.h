#pragma once

#include "geometry/rigid.h"

#include <span>

namespace quoin {

// The rigid motion that moves `from` onto `onto` with the least sum of squared distances (Umeyama 1991, without scale).
// Fewer than three points, or points on a line, leave the turn about it to chance but the distances least.
Rigid fit_rigid(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> onto);

struct TrajectoryError {
    double ate = 0.0;               // RMS distance of positions after rigid alignment [m]
    double ate_median = 0.0;        // [m]
    double relative_position = 0.0; // RMS error of the motion between neighbours [m]
    double relative_rotation = 0.0; // [rad]
};
// Poses of the same frames, world_from_camera; at least one.
TrajectoryError compare_trajectories(std::span<const Rigid> estimate, std::span<const Rigid> truth);

} // namespace quoin
