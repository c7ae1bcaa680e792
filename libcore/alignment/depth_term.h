// The depth term E_d: measured depths lie on the planes of the mesh. It ties poses and planes to the raw depth, where
// the colours of a white wall say nothing.
#pragma once

#include "alignment/observations.h"

namespace quoin {

// r = n . (T^-1 y - c) + s [m], the distance of a measured point y (depth camera) to its plane, and its derivatives by
// the step (omega, v, alpha, s). All are affine in y, so one matrix serves every point of a frame on a plane.
struct DepthRows {
    Eigen::Matrix<double, 9, 4> derivative; // times (y, 1)
    Eigen::Vector4d residual;               // . (y, 1) [m]
};
DepthRows depth_rows(const Rigid& camera_from_world, const CenteredPlane& plane, const TangentBasis& tangents);

// Normal equations of all samples of one frame on one plane: unknowns (omega, v, alpha, s).
struct PairBlock {
    std::uint32_t frame = 0;
    PlaneId plane = kNoPlane;
    Eigen::Matrix<double, 9, 9> H = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
};

// The cost of all observations of one frame on one plane.
struct PairCost {
    std::uint32_t frame = 0;
    PlaneId plane = kNoPlane;
    double cost = 0.0;
};

// Residuals count in units of each sample's sigma; costs turn linear at `huber` sigmas. Sorted by frame, then plane.
std::vector<PairBlock> depth_blocks(const AlignmentState& state, const DepthSamples& samples, double huber);
std::vector<PairCost> depth_costs(const AlignmentState& state, const DepthSamples& samples, double huber);

} // namespace quoin
