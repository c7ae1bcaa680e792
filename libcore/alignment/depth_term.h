// The depth term E_d: measured depths lie on the planes of the mesh. It ties poses and planes to the raw depth, where
// the colours of a white wall say nothing.
#pragma once

#include "alignment/observations.h"

namespace quoin {

// r = n . (T^-1 y - c) + s [m], the distance of a measured point y to its plane, and its derivatives.
struct DepthRow {
    double residual = 0.0;
    Twist pose;    // by (omega, v)
    Vector3 plane; // by (alpha, s)
};
DepthRow depth_row(const Rigid& camera_from_world, const CenteredPlane& plane, const TangentBasis& tangents,
                   const Vector3& p_camera);

// Normal equations of all samples of one frame on one plane: unknowns (omega, v, alpha, s). cost = sum of robust r^2.
struct PairBlock {
    std::uint32_t frame = 0;
    PlaneId plane = kNoPlane;
    Eigen::Matrix<double, 9, 9> H = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
};

// Residuals count in units of each sample's sigma; costs turn linear at `huber` sigmas. Sorted by frame, then plane.
std::vector<PairBlock> depth_blocks(const AlignmentState& state, const DepthSamples& samples, double huber);

} // namespace quoin
