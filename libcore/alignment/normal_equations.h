// The linearised energy as one sparse least-squares system H x = -g, never formed: products run over the observations.
#pragma once

#include "alignment/energy.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

// A step of all unknowns in one vector: 6 per frame, 3 per plane, 9 of the colour camera.
using StepVector = Eigen::VectorXd;
struct StepLayout {
    std::size_t frames = 0, planes = 0;

    Eigen::Index pose(std::size_t k) const { return static_cast<Eigen::Index>(6 * k); }
    Eigen::Index plane(std::size_t p) const { return static_cast<Eigen::Index>(6 * frames + 3 * p); }
    Eigen::Index calibration() const { return static_cast<Eigen::Index>(6 * frames + 3 * planes); }
    Eigen::Index size() const { return calibration() + 9; }
};
AlignmentState moved(const AlignmentState& state, const StepVector& step);

// Colours: frozen, every frame and plane stands alone; eliminated, the rows of a texel are centred (variable
// projection), which ties all frames that see it.
enum class TexelColors { Frozen, Eliminated };

// Consecutive observations of one frame on one plane.
struct ObservationRun {
    std::uint32_t frame, begin, end;
    PlaneId plane;
};

struct WeightedLine {
    const LineObservation* line;
    LineRow row; // times the square root of its weight
};

struct NormalEquations {
    const AlignmentProblem* problem = nullptr;
    StepLayout layout;
    TexelColors colors = TexelColors::Eliminated;
    bool calibrate = false;

    // Of every observation: derivative by (pose, plane) and by calibration (empty when fixed), residual, all times the
    // square root of the weight; and its part in the texel's colour, the unit vector along which rows are centred.
    std::vector<Eigen::Matrix<float, 9, 1>> row, calibration_row;
    std::vector<float> residual, share;
    std::vector<ObservationRun> run;               // by frame, then plane
    std::vector<std::uint32_t> first_run_of_frame; // K + 1
    std::vector<std::uint32_t> first_run_of_plane; // P + 1
    std::vector<std::uint32_t> run_of_plane;       // runs by plane, then frame

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

NormalEquations linearize(const AlignmentProblem& problem, const AlignmentState& state,
                          const std::vector<float>& texel_color, TexelColors colors);

// (H + damping diag(H)) x = -g by conjugate gradients with block-Jacobi preconditioning, to cg_tolerance.
StepVector solve_joint(const NormalEquations& equations, double damping, int max_iterations, double tolerance);
// The same with the diagonal blocks of H alone: each pose by itself, each plane by itself.
StepVector solve_blocks(const NormalEquations& equations, double damping);

} // namespace quoin
