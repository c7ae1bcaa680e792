#include "alignment/color_equations.h"

#include "base/lanes.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quoin {
namespace {

constexpr std::size_t kTexelGrain = 1024;
constexpr int kFlow = 8; // numbers of a flow

// Notation: g = (g_x, g_y) the derivative of a grey by the place (x, y), r = (x, y, 1), and h = (g_x, g_y, g_z) with
// g_z = -(g_x x + g_y y): the third row of a flow F moves a point away, and its picture towards the centre. The
// derivative along F is <h r^T, F>. Its nine terms sum to zero along the diagonal, so that F(2, 2) can be taken off it.
using FlowVector = Eigen::Matrix<double, kFlow, 1>;

FlowVector flow_vector(const Eigen::Matrix3d& F)
{
    FlowVector f;
    f << F(0, 0) - F(2, 2), F(0, 1), F(0, 2), F(1, 0), F(1, 1) - F(2, 2), F(1, 2), F(2, 0), F(2, 1);
    return f;
}

Eigen::Matrix3d flow_matrix(const FlowVector& s)
{
    Eigen::Matrix3d S;
    S << s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], -(s[0] + s[4]);
    return S;
}

// Samples of eight observations; past the end of a run their derivatives are zero.
struct SampleLanes {
    Floats by_x, by_y, x, y;
};

[[gnu::always_inline]] inline SampleLanes load_samples(const GraySamples& samples, std::size_t first, std::size_t count)
{
    return {load_part(&samples.by_x[first], count), load_part(&samples.by_y[first], count),
            load_part(&samples.x[first], count), load_part(&samples.y[first], count)};
}

// The derivatives along F of a run's greys.
void multiply(const GraySamples& samples, const ObservationRun& run, const Eigen::Matrix3d& F,
              std::vector<float>& values)
{
    const Eigen::Matrix<float, kFlow, 1> f = flow_vector(F).cast<float>();
    for (std::size_t o = run.begin; o < run.end; o += kFloats) {
        const SampleLanes s = load_samples(samples, o, run.end - o);
        const Floats away = f[6] * s.x + f[7] * s.y;
        const Floats moved_x = f[0] * s.x + f[1] * s.y + f[2] - s.x * away;
        const Floats moved_y = f[3] * s.x + f[4] * s.y + f[5] - s.y * away;
        store_part(s.by_x * moved_x + s.by_y * moved_y, &values[o], run.end - o);
    }
}

// The sum over a run of value h r^T.
Eigen::Matrix3d weighted_sum(const GraySamples& samples, const ObservationRun& run, const std::vector<float>& values)
{
    std::array<Floats, kFlow> sums{};
    for (std::size_t o = run.begin; o < run.end; o += kFloats) {
        const SampleLanes s = load_samples(samples, o, run.end - o);
        const Floats value = load_part(&values[o], run.end - o);
        const Floats x = value * s.by_x, y = value * s.by_y, xx = x * s.x, yy = y * s.y, z = -(xx + yy);
        sums[0] += xx;
        sums[1] += x * s.y;
        sums[2] += x;
        sums[3] += y * s.x;
        sums[4] += yy;
        sums[5] += y;
        sums[6] += z * s.x;
        sums[7] += z * s.y;
    }
    FlowVector total;
    for (int i = 0; i < kFlow; ++i)
        total[i] = sum(sums[static_cast<std::size_t>(i)]);
    return flow_matrix(total);
}

// What centring leaves of the weights of a run's observations: 1 - weight / sum of weights.
Floats centered_weights(const ColorEquations& eq, std::size_t first, std::size_t count)
{
    std::array<float, kFloats> mean_weight{};
    for (std::size_t i = 0; i < std::min(count, kFloats); ++i)
        mean_weight[i] = eq.mean_weight[eq.problem->observations.texel[first + i]];
    const Floats weight = load_part(&eq.weight[first], count);
    return weight * (1.0f - weight * load(mean_weight.data()));
}

// The sum over a run of weight f f^T, f the eight terms of h r^T.
Eigen::Matrix<double, kFlow, kFlow> second_moments(const ColorEquations& eq, const ObservationRun& run)
{
    Floats sums[kFlow][kFlow] = {};
    for (std::size_t o = run.begin; o < run.end; o += kFloats) {
        const SampleLanes s = load_samples(*eq.samples, o, run.end - o);
        const Floats weight = centered_weights(eq, o, run.end - o);
        const Floats xx = s.by_x * s.x, yy = s.by_y * s.y, z = -(xx + yy);
        const Floats f[kFlow] = {xx, s.by_x * s.y, s.by_x, s.by_y * s.x, yy, s.by_y, z * s.x, z * s.y};
        for (int i = 0; i < kFlow; ++i) {
            const Floats weighted = weight * f[i];
            for (int j = i; j < kFlow; ++j)
                sums[i][j] += weighted * f[j];
        }
    }
    Eigen::Matrix<double, kFlow, kFlow> moments;
    for (int i = 0; i < kFlow; ++i)
        for (int j = i; j < kFlow; ++j)
            moments(i, j) = moments(j, i) = sum(sums[i][j]);
    return moments;
}

// The flows of unit steps.
Eigen::Matrix<double, kFlow, 9> camera_flows(const PlaneFlow& plane)
{
    Eigen::Matrix<double, kFlow, 9> flows;
    for (int i = 0; i < 9; ++i)
        flows.col(i) = flow_vector(plane.flow(CameraStep::Unit(i), Vector3::Zero()));
    return flows;
}
Eigen::Matrix<double, kFlow, 3> plane_flows(const PlaneFlow& plane)
{
    Eigen::Matrix<double, kFlow, 3> flows;
    for (int i = 0; i < 3; ++i)
        flows.col(i) = flow_vector(plane.flow(CameraStep::Zero(), Vector3::Unit(i)));
    return flows;
}

// Takes the part out of the values that a change of the texels' colours explains, and weights the rest.
void center_and_weight(const ColorEquations& eq, std::vector<float>& values)
{
    const Observations& observations = eq.problem->observations;
    const auto center = [&](std::size_t t) {
        float weighted = 0.0f;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
            weighted += eq.weight[observations.of_texel[i]] * values[observations.of_texel[i]];
        const float mean = eq.mean_weight[t] * weighted;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const std::uint32_t o = observations.of_texel[i];
            values[o] = eq.weight[o] * (values[o] - mean);
        }
    };
    parallel_for(eq.mean_weight.size(), center, kTexelGrain);
}

std::vector<float> mean_weights(const AlignmentProblem& problem, const std::vector<float>& weight)
{
    const Observations& observations = problem.observations;
    std::vector<float> mean(problem.texels.size(), 0.0f);
    const auto invert = [&](std::size_t t) {
        float total = 0.0f;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
            total += weight[observations.of_texel[i]];
        if (total > 0.0f) mean[t] = 1.0f / total;
    };
    parallel_for(mean.size(), invert, kTexelGrain);
    return mean;
}

// J^T values, reduced in order.
void scatter(const ColorEquations& eq, const std::vector<float>& values, StepVector& out)
{
    const ObservationRuns& runs = eq.problem->runs;
    std::vector<Vector3> of_run(runs.run.size());
    std::vector<CameraStep> of_frame(eq.layout.frames, CameraStep::Zero());
    parallel_for(eq.layout.frames, [&](std::size_t k) {
        for (std::uint32_t r = runs.first_of_frame[k]; r < runs.first_of_frame[k + 1]; ++r) {
            const Eigen::Matrix3d S = eq.gain[k] * weighted_sum(*eq.samples, runs.run[r], values);
            of_frame[k] += eq.flow[r].camera_gradient(S);
            of_run[r] = eq.flow[r].plane_gradient(S);
        }
    });
    for (std::size_t p = 0; p < eq.layout.planes; ++p)
        for (std::uint32_t i = runs.first_of_plane[p]; i < runs.first_of_plane[p + 1]; ++i)
            out.segment<3>(eq.layout.plane(p)) += of_run[runs.of_plane[i]];
    for (std::size_t k = 0; k < eq.layout.frames; ++k) {
        out.segment<6>(eq.layout.pose(k)) += eq.camera.pose_gradient(of_frame[k]);
        out.segment<9>(eq.layout.calibration()) += eq.camera.calibration_gradient(of_frame[k]);
    }
}

} // namespace

void ColorEquations::add_gradient(std::vector<float> residual, StepVector& out) const
{
    center_and_weight(*this, residual);
    scatter(*this, residual, out);
}

void ColorEquations::add_product(const StepVector& x, StepVector& out) const
{
    const ObservationRuns& runs = problem->runs;
    std::vector<float> values(weight.size());
    parallel_for(layout.frames, [&](std::size_t k) {
        const CameraStep step = camera.step(x.segment<6>(layout.pose(k)), x.segment<9>(layout.calibration()));
        for (std::uint32_t r = runs.first_of_frame[k]; r < runs.first_of_frame[k + 1]; ++r) {
            const Vector3 by_plane = x.segment<3>(layout.plane(runs.run[r].plane));
            multiply(*samples, runs.run[r], gain[k] * flow[r].flow(step, by_plane), values);
        }
    });
    center_and_weight(*this, values);
    scatter(*this, values, out);
}

ColorBlocks ColorEquations::blocks() const
{
    const ObservationRuns& runs = problem->runs;
    std::vector<Eigen::Matrix<double, 9, 9>> of_frame(layout.frames, Eigen::Matrix<double, 9, 9>::Zero());
    std::vector<Eigen::Matrix3d> of_run(runs.run.size());
    parallel_for(layout.frames, [&](std::size_t k) {
        for (std::uint32_t r = runs.first_of_frame[k]; r < runs.first_of_frame[k + 1]; ++r) {
            const Eigen::Matrix<double, kFlow, kFlow> moments = gain[k] * gain[k] * second_moments(*this, runs.run[r]);
            const auto by_camera = camera_flows(flow[r]);
            const auto by_plane = plane_flows(flow[r]);
            of_frame[k].noalias() += by_camera.transpose() * (moments * by_camera).eval();
            of_run[r].noalias() = by_plane.transpose() * (moments * by_plane).eval();
        }
    });
    ColorBlocks result;
    result.plane.assign(layout.planes, Eigen::Matrix3d::Zero());
    for (std::size_t r = 0; r < of_run.size(); ++r)
        result.plane[runs.run[r].plane] += of_run[r];
    const Eigen::Matrix<double, 6, 6> by_pose = camera.by_pose();
    CameraStep scale = CameraStep::Ones();
    scale[7] /= camera.fx;
    scale[8] /= camera.fy;
    for (const auto& frame : of_frame) {
        result.pose.push_back(by_pose.transpose() * frame.topLeftCorner<6, 6>() * by_pose);
        result.calibration += scale.asDiagonal() * frame * scale.asDiagonal();
    }
    return result;
}

std::vector<float> color_residuals(const AlignmentProblem& problem, const AlignmentState& state,
                                   const GraySamples& samples, const std::vector<float>& texel_color)
{
    const Observations& observations = problem.observations;
    std::vector<float> residual(observations.size());
    parallel_for(state.exposure.size(), [&](std::size_t k) {
        const auto gain = static_cast<float>(state.exposure[k].gain), bias = static_cast<float>(state.exposure[k].bias);
        for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o)
            residual[o] = gain * samples.value[o] + bias - texel_color[observations.texel[o]];
    });
    return residual;
}

ColorEquations color_equations(const AlignmentProblem& problem, const AlignmentState& state, const GraySamples& samples,
                               const std::vector<float>& residual, TexelColors colors)
{
    const OptimizeTextureParams& params = problem.scene.params;
    ColorEquations eq{
        &problem, &samples, {state.camera_from_world.size(), state.plane.size()}, {}, {}, {}, camera_flow(state.color),
        {}};
    const auto huber = static_cast<float>(params.huber_color);
    const auto scale = static_cast<float>(1.0 / (params.sigma_color * params.sigma_color));
    eq.weight.resize(residual.size());
    std::ranges::transform(residual, eq.weight.begin(),
                           [&](float r) { return scale * (huber / std::max(std::abs(r), huber)); });
    eq.mean_weight = colors == TexelColors::Eliminated ? mean_weights(problem, eq.weight)
                                                       : std::vector<float>(problem.texels.size(), 0.0f);
    for (const Exposure& exposure : state.exposure)
        eq.gain.push_back(exposure.gain);
    eq.flow.reserve(problem.runs.run.size());
    for (const ObservationRun& run : problem.runs.run)
        eq.flow.push_back(
            plane_flow(state.color.color_from_depth * state.camera_from_world[run.frame], state.plane[run.plane]));
    return eq;
}

} // namespace quoin
