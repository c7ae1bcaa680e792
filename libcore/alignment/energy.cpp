#include "alignment/energy.h"

#include "alignment/photometric.h"
#include "base/parallel.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace quoin {
namespace {

constexpr int kReweightings = 3;

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Cost of every observation, in units of sigma_color.
std::vector<float> color_costs(const AlignmentProblem& problem, const std::vector<float>& gray,
                               const std::vector<float>& texel_color)
{
    const OptimizeTextureParams& params = problem.scene.params;
    std::vector<float> cost(gray.size());
    const double scale = 1.0 / (params.sigma_color * params.sigma_color);
    for (std::size_t o = 0; o < gray.size(); ++o) {
        const double r = gray[o] - texel_color[problem.observations.texel[o]];
        cost[o] = static_cast<float>(scale * huber_cost(r, params.huber_color));
    }
    return cost;
}

void add_color(BlockEnergies& result, const AlignmentProblem& problem, const std::vector<float>& cost)
{
    const Observations& observations = problem.observations;
    for (std::size_t o = 0; o < cost.size(); ++o) {
        result.of_frame[observations.frame[o]] += cost[o];
        result.of_plane[problem.texels.plane[observations.texel[o]]] += cost[o];
        result.sum.color += cost[o];
    }
}

// Adds weighted robust depth costs to their frames and planes; returns their sum.
double add_depths(BlockEnergies& result, const AlignmentState& state, const DepthSamples& samples, double weight,
                  double huber)
{
    if (weight == 0.0 || samples.sample.empty()) return 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < state.camera_from_world.size(); ++k) {
        const Rigid world_from_camera = state.camera_from_world[k].inverse();
        for (std::uint32_t i = samples.first_of_frame[k]; i < samples.first_of_frame[k + 1]; ++i) {
            const DepthSample& sample = samples.sample[i];
            const Vector3 p_world = world_from_camera * sample.p_camera.cast<double>();
            const double cost =
                weight * huber_cost(state.plane[sample.plane].signed_distance(p_world) / sample.sigma, huber);
            result.of_frame[k] += cost;
            result.of_plane[sample.plane] += cost;
            sum += cost;
        }
    }
    return sum;
}

double add_lines(BlockEnergies& result, const AlignmentProblem& problem, const AlignmentState& state)
{
    const OptimizeTextureParams& params = problem.scene.params;
    const auto cost = line_costs(state, problem.lines, params.sigma_line, params.huber_line);
    for (std::size_t i = 0; i < cost.size(); ++i) {
        result.of_frame[problem.lines[i].frame] += params.lambda_t * cost[i];
        for (const PlaneId p : problem.lines[i].plane)
            result.of_plane[p] += params.lambda_t * cost[i];
    }
    return params.lambda_t * sum_of(cost);
}

double add_planes(BlockEnergies& result, const AlignmentProblem& problem, const AlignmentState& state)
{
    const double weight = problem.lambda_p / (problem.scene.params.sigma_plane * problem.scene.params.sigma_plane);
    double sum = 0.0;
    for (std::size_t p = 0; p < state.plane.size(); ++p) {
        const double cost = weight * plane_block(problem.scatter[p], state.plane[p]).cost;
        result.of_plane[p] += cost;
        sum += cost;
    }
    return sum;
}

double add_priors(BlockEnergies& result, const AlignmentProblem& problem, const AlignmentState& state)
{
    const PosePrior prior = pose_prior(problem.scene.params);
    double sum = calibration_prior(problem.scene.params, state.color, problem.input.color).cost;
    for (std::size_t k = 0; k < state.camera_from_world.size(); ++k) {
        const PoseBlock block = prior_block(prior, state.camera_from_world[k], problem.input.camera_from_world[k]);
        const double cost = problem.prior_weight[k] * block.cost;
        result.of_frame[k] += cost;
        sum += cost;
    }
    return sum;
}

BlockEnergies energies_of_grays(const AlignmentProblem& problem, const AlignmentState& state,
                                const std::vector<float>& gray, const std::vector<float>& texel_color)
{
    const OptimizeTextureParams& params = problem.scene.params;
    BlockEnergies result;
    result.of_frame.assign(state.camera_from_world.size(), 0.0);
    result.of_plane.assign(state.plane.size(), 0.0);
    add_color(result, problem, color_costs(problem, gray, texel_color));
    result.sum.depth = add_depths(result, state, problem.depths, params.lambda_d, params.huber_depth);
    result.sum.line = add_lines(result, problem, state) +
                      add_depths(result, state, problem.line_depths, params.lambda_t, params.huber_depth);
    result.sum.plane = add_planes(result, problem, state);
    result.sum.prior = add_priors(result, problem, state);
    return result;
}

} // namespace

std::vector<float> best_colors(const AlignmentProblem& problem, const AlignmentState& state)
{
    const auto gray = corrected_grays(problem.scene, state, problem.texels, problem.observations, problem.level);
    return texel_colors(problem.observations, gray, problem.scene.params.huber_color, kReweightings);
}

BlockEnergies energies(const AlignmentProblem& problem, const AlignmentState& state,
                       const std::vector<float>& texel_color)
{
    const auto gray = corrected_grays(problem.scene, state, problem.texels, problem.observations, problem.level);
    return energies_of_grays(problem, state, gray, texel_color);
}

Energy energy(const AlignmentProblem& problem, const AlignmentState& state)
{
    const auto gray = corrected_grays(problem.scene, state, problem.texels, problem.observations, problem.level);
    const auto color = texel_colors(problem.observations, gray, problem.scene.params.huber_color, kReweightings);
    return energies_of_grays(problem, state, gray, color).sum;
}

CalibrationBlock calibration_prior(const OptimizeTextureParams& params, const ColorCamera& color,
                                   const ColorCamera& input)
{
    const PosePrior position = pose_prior(radians(params.prior_camera_rotation), params.prior_camera_translation);
    const PoseBlock block = prior_block(position, color.color_from_depth, input.color_from_depth);
    const Vector3 weight(1.0 / params.prior_focal, 1.0 / params.prior_center, 1.0 / params.prior_center);
    const Vector3 r =
        weight.cwiseProduct(Vector3(std::log(color.camera.fx / input.camera.fx), color.camera.cx - input.camera.cx,
                                    color.camera.cy - input.camera.cy));
    CalibrationBlock result;
    result.cost = block.cost + r.squaredNorm();
    result.g.head<6>() = block.g;
    result.g.tail<3>() = weight.cwiseProduct(r);
    result.H.topLeftCorner<6, 6>() = block.H;
    result.H.bottomRightCorner<3, 3>() = weight.cwiseAbs2().asDiagonal();
    return result;
}

PosePrior pose_prior(const OptimizeTextureParams& params)
{
    return pose_prior(radians(params.prior_rotation), params.prior_translation);
}

} // namespace quoin
