// Pull of every camera to its input pose: it holds what neither colour nor depth sees. Observations of a frame share
// errors (lens, depth bias, rough surfaces), so that thousands of them would outvote a prior that counts once and bend
// the room along what they hardly determine, such as its scale: it counts once for every few of them.
#pragma once

#include "alignment/state.h"

namespace quoin {

struct PosePrior {
    Twist inverse_sigma; // [1/rad] and [1/m]
};
PosePrior pose_prior(double sigma_rotation_rad, double sigma_translation);

// cost = |D log(T T0^-1)|^2, half its gradient and its Gauss-Newton matrix by (omega, v).
struct PoseBlock {
    double cost = 0.0;
    Twist g = Twist::Zero();
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
};
PoseBlock prior_block(const PosePrior& prior, const Rigid& camera_from_world, const Rigid& input_camera_from_world);

} // namespace quoin
