// The energy E_c + lambda_p E_p + lambda_t E_t + lambda_d E_d of a fixed set of observations.
#pragma once

#include "alignment/depth_term.h"
#include "alignment/line_term.h"
#include "alignment/photometric.h"
#include "alignment/plane_term.h"
#include "alignment/pose_prior.h"

#include <cstdint>
#include <vector>

namespace quoin {

// What the squares of grey differences and of depth residuals, in units of their noise, count.
struct DataWeights {
    double color = 0.0, depth = 0.0;
};
DataWeights given_weights(const OptimizeTextureParams& params);

// Everything that is summed, at one pyramid level. Residuals count in units of their noise.
struct AlignmentProblem {
    const AlignmentScene& scene;
    int level = 0;
    Texels texels;
    Observations observations;
    ObservationRuns runs; // of `observations`
    DepthSamples depths;
    std::vector<LineObservation> lines; // line_term reprojection
    DepthSamples line_depths;           // line_term depth
    std::vector<PlaneScatter> scatter;  // P
    double lambda_p = 0.0;
    DataWeights weight;
    AlignmentState input;                    // where the priors pull to
    std::vector<std::uint8_t> frame_is_free; // K; others keep their pose
    std::vector<std::uint8_t> plane_is_free; // P
    std::vector<double> prior_weight;        // K, of the pull to the input pose
    bool color_camera_is_free = false;
};

// What the square of a point's distance to plane p counts in the plane term. Cameras' errors bend the dense mesh as a
// whole, so that the points of a large plane tell no more of it than those of a part: of `shared_area`.
double plane_weight(const AlignmentProblem& problem, std::size_t p);

// Weighted sums of each term.
struct Energy {
    double color = 0.0, plane = 0.0, line = 0.0, depth = 0.0, prior = 0.0;
    double total() const { return color + plane + line + depth + prior; }
};
struct BlockEnergies {
    Energy sum;
    std::vector<double> of_frame; // K: all terms in which the frame's pose takes part
    std::vector<double> of_plane; // P: all terms in which the plane takes part
};

// A state with everything that only looking at the images tells of it.
struct Fit {
    AlignmentState state;
    GraySamples samples;
    std::vector<float> color; // of every texel: those that fit the state best
    Energy energy;
};
GraySamples sample_grays(const AlignmentProblem& problem, const AlignmentState& state);
Fit fit(const AlignmentProblem& problem, AlignmentState state);
// The same with other exposures, if they lower the energy: no image is looked at again.
Fit with_exposures(const AlignmentProblem& problem, Fit before, std::vector<Exposure> exposure);

// At given colours. The images are looked at, but nothing is kept of it.
BlockEnergies energies(const AlignmentProblem& problem, const AlignmentState& state,
                       const std::vector<float>& texel_color);
// The same when the costs of the colours are known: of every run.
BlockEnergies energies(const AlignmentProblem& problem, const AlignmentState& state,
                       const std::vector<PairCost>& color_costs);

// Prior of the shared calibration: squared deviations from the input in units of their expected errors.
struct CalibrationBlock {
    double cost = 0.0;
    CalibrationStep g = CalibrationStep::Zero();
    Eigen::Matrix<double, 9, 9> H = Eigen::Matrix<double, 9, 9>::Zero();
};
CalibrationBlock calibration_prior(const OptimizeTextureParams& params, const ColorCamera& color,
                                   const ColorCamera& input);

PosePrior pose_prior(const OptimizeTextureParams& params);

} // namespace quoin
