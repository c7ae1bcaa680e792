#include "alignment/energy.h"

#include "alignment/exposure.h"
#include "alignment/frame_picture.h"
#include "base/parallel.h"
#include "geometry/units.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace quoin {
namespace {

constexpr int kReweightings = 3;
constexpr std::size_t kRunGrain = 64;

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Adds costs to their frames and planes; returns their sum.
double add_pairs(BlockEnergies& result, const std::vector<PairCost>& pairs, double weight)
{
    double sum = 0.0;
    for (const PairCost& pair : pairs) {
        result.of_frame[pair.frame] += weight * pair.cost;
        result.of_plane[pair.plane] += weight * pair.cost;
        sum += weight * pair.cost;
    }
    return sum;
}

// Robust squares of grey differences, eight at a time.
struct ColorCosts {
    const Observations& observations;
    const std::vector<float>& texel_color;
    float huber;

    // Of the first eight of the observations from o on that lie before `end`.
    Floats operator()(std::size_t o, std::size_t end, const Floats& gray) const
    {
        const Ints texel = load_part(&observations.texel[o], end - o);
        return huber_cost(first_of(gray - gather(texel_color.data(), texel), end - o), huber);
    }
};

ColorCosts color_cost(const AlignmentProblem& problem, const std::vector<float>& texel_color)
{
    return {problem.observations, texel_color, static_cast<float>(problem.scene.params.huber_color)};
}

// Of every run; sum_of(first, end, run) is that of a few of its observations, few enough for single precision.
template <class Sum>
std::vector<PairCost> costs_of_runs(const AlignmentProblem& problem, const Sum& sum_of)
{
    std::vector<PairCost> costs(problem.runs.run.size());
    const auto cost_of = [&](std::size_t r) {
        const ObservationRun& run = problem.runs.run[r];
        costs[r] = {run.frame, run.plane, 0.0};
        for (std::size_t first = run.begin; first < run.end; first += kPlaces * kFloats)
            costs[r].cost += sum(sum_of(first, std::min<std::size_t>(run.end, first + kPlaces * kFloats), run));
    };
    parallel_for(costs.size(), cost_of, kRunGrain);
    return costs;
}

std::vector<PairCost> color_costs(const AlignmentProblem& problem, const std::vector<float>& gray,
                                  const std::vector<float>& texel_color)
{
    const ColorCosts cost_of = color_cost(problem, texel_color);
    return costs_of_runs(problem, [&](std::size_t first, std::size_t end, const ObservationRun&) {
        Floats cost{};
        for (std::size_t o = first; o < end; o += kFloats)
            cost += cost_of(o, end, load_part(&gray[o], end - o));
        return cost;
    });
}

std::vector<PairCost> color_costs(const AlignmentProblem& problem, const AlignmentState& state,
                                  const std::vector<float>& texel_color)
{
    const ColorCosts cost_of = color_cost(problem, texel_color);
    return costs_of_runs(problem, [&](std::size_t first, std::size_t end, const ObservationRun& run) {
        const FramePicture picture = frame_picture(problem.scene, state, run.frame, problem.level);
        const auto projection = picture.projection(state.plane[run.plane]);
        const Exposure& exposure = state.exposure[run.frame];
        const auto gain = static_cast<float>(exposure.gain), bias = static_cast<float>(exposure.bias);
        Places places;
        for (std::size_t i = 0, o = first; o < end; ++i, o += kFloats)
            places[i] =
                picture.place(projection, problem.texels.p_world, load_part(&problem.observations.texel[o], end - o));
        Floats cost{};
        for (std::size_t i = 0, o = first; o < end; ++i, o += kFloats)
            cost += cost_of(o, end, gain * picture.sample(places[i]).value + bias);
        return cost;
    });
}

double add_depths(BlockEnergies& result, const AlignmentState& state, const DepthSamples& samples, double weight,
                  double huber)
{
    return weight == 0.0 ? 0.0 : add_pairs(result, depth_costs(state, samples, huber), weight);
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
    double sum = 0.0;
    for (std::size_t p = 0; p < state.plane.size(); ++p) {
        const double cost = plane_weight(problem, p) * plane_block(problem.scatter[p], state.plane[p]).cost;
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

} // namespace

DataWeights given_weights(const OptimizeTextureParams& params)
{
    return {1.0 / (params.sigma_color * params.sigma_color), params.lambda_d};
}

double plane_weight(const AlignmentProblem& problem, std::size_t p)
{
    const OptimizeTextureParams& params = problem.scene.params;
    const double area = problem.scatter[p].weight * problem.texels.spacing * problem.texels.spacing;
    const double independent = 1.0 / (1.0 + area / params.shared_area);
    return problem.lambda_p * independent / (params.sigma_plane * params.sigma_plane);
}

BlockEnergies energies(const AlignmentProblem& problem, const AlignmentState& state,
                       const std::vector<PairCost>& color_costs)
{
    const OptimizeTextureParams& params = problem.scene.params;
    BlockEnergies result;
    result.of_frame.assign(state.camera_from_world.size(), 0.0);
    result.of_plane.assign(state.plane.size(), 0.0);
    result.sum.color = add_pairs(result, color_costs, problem.weight.color);
    result.sum.depth = add_depths(result, state, problem.depths, problem.weight.depth, params.huber_depth);
    result.sum.line = add_lines(result, problem, state) +
                      add_depths(result, state, problem.line_depths, params.lambda_t, params.huber_depth);
    result.sum.plane = add_planes(result, problem, state);
    result.sum.prior = add_priors(result, problem, state);
    return result;
}

BlockEnergies energies(const AlignmentProblem& problem, const AlignmentState& state,
                       const std::vector<float>& texel_color)
{
    return energies(problem, state, color_costs(problem, state, texel_color));
}

GraySamples sample_grays(const AlignmentProblem& problem, const AlignmentState& state)
{
    return sample_grays(problem.scene, state, {problem.texels, problem.observations, problem.runs}, problem.level);
}

Fit fit(const AlignmentProblem& problem, AlignmentState state)
{
    Fit result;
    result.samples = sample_grays(problem, state);
    const auto gray = exposed(problem.observations, result.samples.value, state.exposure);
    result.color = texel_colors(problem.observations, gray, problem.scene.params.huber_color, kReweightings);
    result.energy = energies(problem, state, color_costs(problem, gray, result.color)).sum;
    result.state = std::move(state);
    return result;
}

Fit with_exposures(const AlignmentProblem& problem, Fit before, std::vector<Exposure> exposure)
{
    const auto gray = exposed(problem.observations, before.samples.value, exposure);
    auto color = texel_colors(problem.observations, gray, problem.scene.params.huber_color, kReweightings);
    double energy = 0.0;
    for (const PairCost& pair : color_costs(problem, gray, color))
        energy += problem.weight.color * pair.cost;
    if (!(energy < before.energy.color)) return before;
    before.energy.color = energy;
    before.color = std::move(color);
    before.state.exposure = std::move(exposure);
    return before;
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
