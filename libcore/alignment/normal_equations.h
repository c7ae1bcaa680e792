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

struct NormalEquations {
    const AlignmentProblem* problem = nullptr;
    StepLayout layout;
    bool calibrate = false;

    ColorEquations color;
    std::vector<PairBlock> depth; // weighted
    std::vector<WeightedLine> line;
    std::vector<Eigen::Matrix<double, 6, 6>> pose_prior; // of the terms in one pose or one plane alone
    std::vector<Eigen::Matrix3d> plane_prior;
    Eigen::Matrix<double, 9, 9> calibration_prior = Eigen::Matrix<double, 9, 9>::Zero();

    StepVector gradient;
    // Diagonal blocks of H; those of what is not free are identities.
    std::vector<Eigen::Matrix<double, 6, 6>> pose_block;
    std::vector<Eigen::Matrix3d> plane_block;
    Eigen::Matrix<double, 9, 9> calibration_block = Eigen::Matrix<double, 9, 9>::Identity();

    StepVector apply(const StepVector& x) const; // H x, with zeros for what is not free
};

// The equations refer to the problem and to the samples of the state.
NormalEquations linearize(const AlignmentProblem& problem, const AlignmentState& state, const GraySamples& samples,
                          const std::vector<float>& texel_color, TexelColors colors);

// (H + damping diag(H)) x = -g by conjugate gradients with block-Jacobi preconditioning, to cg_tolerance.
StepVector solve_joint(const NormalEquations& equations, double damping, int max_iterations, double tolerance);
// The same with the diagonal blocks of H alone: each pose by itself, each plane by itself.
StepVector solve_blocks(const NormalEquations& equations, double damping);

} // namespace quoin
