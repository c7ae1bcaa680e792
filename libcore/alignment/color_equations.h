// The linearised colour term. Its rows J are never stored: the samples of a state and the flow of every frame on every
// plane say it all.
#pragma once

#include "alignment/energy.h"
#include "alignment/plane_flow.h"
#include "alignment/step.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

// Diagonal blocks of J^T W J. Eliminating the texels' colours takes its part off each view; the coupling of views of
// one plane or of the camera through the colours is left out.
struct ColorBlocks {
    std::vector<Eigen::Matrix<double, 6, 6>> pose; // K
    std::vector<Eigen::Matrix3d> plane;            // P
    Eigen::Matrix<double, 9, 9> calibration = Eigen::Matrix<double, 9, 9>::Zero();
};

// At frozen colours every frame and plane stands alone.
struct FrozenColors {
    StepVector gradient; // J^T W residual
    ColorBlocks blocks;
    std::vector<PairCost> cost; // of every run: robust squares of its residuals, the corrected greys less the colours
};
// One pass over the images: nothing is kept of an observation.
FrozenColors frozen_colors(const AlignmentProblem& problem, const AlignmentState& state,
                           const std::vector<float>& texel_color);

// With the colours eliminated the rows of a texel are centred (variable projection), which ties all frames that see it.
struct ColorEquations {
    const AlignmentProblem* problem = nullptr;
    const GraySamples* samples = nullptr;
    StepLayout layout;
    std::vector<float> weight;      // of every observation's squared residual
    std::vector<float> mean_weight; // of every texel: 1 / sum of its views' weights
    std::vector<PlaneFlow> flow;    // of every run
    CameraFlow camera;
    std::vector<double> gain; // K
    StepVector gradient;      // J^T W residual
    ColorBlocks blocks;

    void add_product(const StepVector& x, StepVector& out) const; // J^T W J x
};

// The equations refer to the problem and to the samples of the fit.
ColorEquations color_equations(const AlignmentProblem& problem, const Fit& fit);

} // namespace quoin
