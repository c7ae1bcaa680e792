// The linearised energy as one sparse least-squares system H x = -g, never formed: products run over the observations.
#pragma once

#include "alignment/color_equations.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

struct WeightedLine {
    const LineObservation* line;
    LineRow row; // times the square root of its weight
};

// The part of H that depths tie a frame and a plane by.
struct DepthCoupling {
    std::uint32_t frame = 0;
    PlaneId plane = kNoPlane;
    Eigen::Matrix<double, 6, 3> H;
};

struct NormalEquations {
    const AlignmentProblem* problem = nullptr;
    StepLayout layout;
    bool calibrate = false;

    ColorEquations color;
    std::vector<WeightedLine> line;
    std::vector<DepthCoupling> depth; // of poses and planes; what depths say of either alone is in the next two
    std::vector<Eigen::Matrix<double, 6, 6>> pose_own; // K, of all terms but colours and lines
    std::vector<Eigen::Matrix3d> plane_own;            // P
    Eigen::Matrix<double, 9, 9> calibration_prior = Eigen::Matrix<double, 9, 9>::Zero();

    StepVector gradient;
    // Diagonal blocks of H; those of what is not free are identities.
    std::vector<Eigen::Matrix<double, 6, 6>> pose_block;
    std::vector<Eigen::Matrix3d> plane_block;
    Eigen::Matrix<double, 9, 9> calibration_block = Eigen::Matrix<double, 9, 9>::Identity();

    StepVector apply(const StepVector& x) const; // H x, with zeros for what is not free
};

// With the texels' colours eliminated. The equations refer to the problem and to the samples of the fit.
NormalEquations linearize(const AlignmentProblem& problem, const Fit& fit);
// With frozen ones: for solve_blocks, which does without products.
NormalEquations linearize(const AlignmentProblem& problem, const AlignmentState& state, FrozenColors colors);

// (H + damping diag(H)) x = -g by conjugate gradients with block-Jacobi preconditioning, to cg_tolerance.
StepVector solve_joint(const NormalEquations& equations, double damping, int max_iterations, double tolerance);
// The same with the diagonal blocks of H alone: each pose by itself, each plane by itself.
StepVector solve_blocks(const NormalEquations& equations, double damping);

} // namespace quoin
