// The linearised colour term. Its rows J are never stored: the samples of a state and the flow of every frame on every
// plane say it all.
#pragma once

#include "alignment/energy.h"
#include "alignment/plane_flow.h"
#include "alignment/step.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

// Colours: frozen, every frame and plane stands alone; eliminated, the rows of a texel are centred (variable
// projection), which ties all frames that see it.
enum class TexelColors { Frozen, Eliminated };

// Diagonal blocks of J^T W J. Centring takes its part off each view; the coupling of views of one plane or of the
// camera through the colours is left out.
struct ColorBlocks {
    std::vector<Eigen::Matrix<double, 6, 6>> pose; // K
    std::vector<Eigen::Matrix3d> plane;            // P
    Eigen::Matrix<double, 9, 9> calibration = Eigen::Matrix<double, 9, 9>::Zero();
};

struct ColorEquations {
    const AlignmentProblem* problem = nullptr;
    const GraySamples* samples = nullptr;
    StepLayout layout;
    std::vector<float> weight;      // of every observation's squared residual
    std::vector<float> mean_weight; // of every texel: 1 / sum of its views' weights; 0 = frozen
    std::vector<PlaneFlow> flow;    // of every run
    CameraFlow camera;
    std::vector<double> gain; // K

    void add_gradient(std::vector<float> residual, StepVector& out) const; // J^T W residual
    void add_product(const StepVector& x, StepVector& out) const;          // J^T W J x
    ColorBlocks blocks() const;
};

// Residuals: corrected greys less the colours of their texels. The equations refer to the problem and to `samples`,
// those of the state.
std::vector<float> color_residuals(const AlignmentProblem& problem, const AlignmentState& state,
                                   const GraySamples& samples, const std::vector<float>& texel_color);
ColorEquations color_equations(const AlignmentProblem& problem, const AlignmentState& state, const GraySamples& samples,
                               const std::vector<float>& residual, TexelColors colors);

} // namespace quoin
