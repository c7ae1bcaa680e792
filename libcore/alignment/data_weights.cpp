#include "alignment/data_weights.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr double kLeastNoise = 0.5;  // of what is expected; below it, residuals do not tell noise from the fit's own
constexpr double kFewOutliers = 3.0; // depth residual [sigmas] from which the cost is linear

// Of residuals, in units of the square of the noise that is expected.
double noise(double mean_square) { return std::max(mean_square, kLeastNoise * kLeastNoise); }

// Every texel's colour is fitted and takes one of its views.
double mean_square_of_colors(const AlignmentProblem& problem, const AlignmentState& state)
{
    const std::size_t views = problem.observations.size(), texels = problem.texels.size();
    if (views <= texels) return 1.0;
    const double sum = fit(problem, state).energy.color / problem.weight.color;
    return sum * given_weights(problem.scene.params).color / static_cast<double>(views - texels);
}

double mean_square_of_depths(const AlignmentProblem& problem, const AlignmentState& state)
{
    if (problem.depths.size() == 0) return 1.0;
    double sum = 0.0;
    for (const PairCost& pair : depth_costs(state, problem.depths, kFewOutliers))
        sum += pair.cost;
    return sum / static_cast<double>(problem.depths.size());
}

} // namespace

// Greys that differ by more than their noise show errors of poses yet, or of the model.
DataWeights estimated_weights(const AlignmentProblem& problem, const AlignmentState& state)
{
    const DataWeights given = given_weights(problem.scene.params);
    return {given.color / std::min(1.0, noise(mean_square_of_colors(problem, state))),
            given.depth / noise(mean_square_of_depths(problem, state))};
}

} // namespace quoin
