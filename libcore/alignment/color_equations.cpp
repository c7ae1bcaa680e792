#include "alignment/color_equations.h"

#include "alignment/flow_sums.h"
#include "alignment/frame_picture.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace quoin {
namespace {

constexpr std::size_t kTexelGrain = 1024;

// Huber's weight of a grey difference over the square of its noise.
struct ColorWeight {
    float huber, scale;

    explicit ColorWeight(const AlignmentProblem& problem)
        : huber(static_cast<float>(problem.scene.params.huber_color)), scale(static_cast<float>(problem.weight.color))
    {
    }
    Floats operator()(const Floats& residual) const
    {
        const Floats size = size_of(residual);
        return scale * (huber / (size > huber ? size : each(huber)));
    }
};

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

PlaneFlow flow_of(const AlignmentState& state, const ObservationRun& run)
{
    return plane_flow(state.color.color_from_depth * state.camera_from_world[run.frame], state.plane[run.plane]);
}

// J^T values from their sums over the runs of each frame and plane, in order.
struct Gradient {
    std::vector<CameraStep> of_frame;
    std::vector<Vector3> of_run;

    Gradient(std::size_t frames, std::size_t runs) : of_frame(frames, CameraStep::Zero()), of_run(runs) {}
    void set(const ObservationRun& run, std::size_t r, const PlaneFlow& flow, const FlowVector& first)
    {
        const Eigen::Matrix3d S = flow_matrix(first);
        of_frame[run.frame] += flow.camera_gradient(S);
        of_run[r] = flow.plane_gradient(S);
    }
    void add_to(StepVector& out, const ObservationRuns& runs, const StepLayout& layout, const CameraFlow& camera) const
    {
        for (std::size_t p = 0; p < layout.planes; ++p)
            for (std::uint32_t i = runs.first_of_plane[p]; i < runs.first_of_plane[p + 1]; ++i)
                out.segment<3>(layout.plane(p)) += of_run[runs.of_plane[i]];
        for (std::size_t k = 0; k < layout.frames; ++k) {
            out.segment<6>(layout.pose(k)) += camera.pose_gradient(of_frame[k]);
            out.segment<9>(layout.calibration()) += camera.calibration_gradient(of_frame[k]);
        }
    }
};

// The same for diagonal blocks.
struct Blocks {
    std::vector<Eigen::Matrix<double, 9, 9>> of_frame;
    std::vector<Eigen::Matrix3d> of_run;

    Blocks(std::size_t frames, std::size_t runs) : of_frame(frames, Eigen::Matrix<double, 9, 9>::Zero()), of_run(runs)
    {
    }
    void set(const ObservationRun& run, std::size_t r, const PlaneFlow& flow,
             const Eigen::Matrix<double, kFlow, kFlow>& lower)
    {
        const Eigen::Matrix<double, kFlow, kFlow> second = lower.selfadjointView<Eigen::Lower>();
        const auto by_camera = camera_flows(flow);
        const auto by_plane = plane_flows(flow);
        of_frame[run.frame].noalias() += by_camera.transpose() * (second * by_camera).eval();
        of_run[r].noalias() = by_plane.transpose() * (second * by_plane).eval();
    }
    ColorBlocks sums(const ObservationRuns& runs, const StepLayout& layout, const CameraFlow& camera) const
    {
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
};

// Calls visit(run, its number) for all runs, frame by frame.
template <class Visit>
void for_each_run(const ObservationRuns& runs, const Visit& visit)
{
    parallel_for(runs.first_of_frame.size() - 1, [&](std::size_t k) {
        for (std::uint32_t r = runs.first_of_frame[k]; r < runs.first_of_frame[k + 1]; ++r)
            visit(runs.run[r], r);
    });
}

SampleLanes load_samples(const GraySamples& samples, std::size_t first, std::size_t count)
{
    const auto part = [&](const std::vector<float>& values) { return load_part(&values[first], count); };
    return {part(samples.value), part(samples.by_x), part(samples.by_y), part(samples.x), part(samples.y)};
}

// Weights, and of every texel with the colour eliminated: what it needs to centre its rows.
struct Weighting {
    std::vector<float> weighted; // residual of every observation times its weight
    std::vector<float> mean;     // of a texel's residuals
};

Weighting weigh(ColorEquations& eq, const Fit& fit)
{
    const Observations& observations = eq.problem->observations;
    const ColorWeight weight_of(*eq.problem);
    eq.weight.resize(observations.size());
    eq.mean_weight.assign(eq.problem->texels.size(), 0.0f);
    Weighting result{std::vector<float>(observations.size()), eq.mean_weight};
    parallel_for(eq.layout.frames, [&](std::size_t k) {
        const Exposure& exposure = fit.state.exposure[k];
        const auto gain = static_cast<float>(exposure.gain), bias = static_cast<float>(exposure.bias);
        const std::size_t end = observations.first_of_frame[k + 1];
        for (std::size_t o = observations.first_of_frame[k]; o < end; o += kFloats) {
            const Floats color = gather(fit.color.data(), load_part(&observations.texel[o], end - o));
            const Floats residual = gain * load_part(&fit.samples.value[o], end - o) + bias - color;
            const Floats weight = weight_of(residual);
            store_part(weight, &eq.weight[o], end - o);
            store_part(weight * residual, &result.weighted[o], end - o);
        }
    });
    const auto center = [&](std::size_t t) {
        float weight = 0.0f, weighted = 0.0f;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            weight += eq.weight[observations.of_texel[i]];
            weighted += result.weighted[observations.of_texel[i]];
        }
        if (weight > 0.0f) eq.mean_weight[t] = 1.0f / weight;
        result.mean[t] = eq.mean_weight[t] * weighted;
    };
    parallel_for(result.mean.size(), center, kTexelGrain);
    return result;
}

// The sums over a run of the centred rows, and their residuals.
FlowSums centered_sums(const ColorEquations& eq, const Weighting& weighting, const ObservationRun& run)
{
    FlowSums sums;
    FlowTile tile;
    for (std::size_t o = run.begin; o < run.end; o += kFloats) {
        const std::size_t count = run.end - o;
        const SampleLanes s = load_samples(*eq.samples, o, count);
        const Ints texel = load_part(&eq.problem->observations.texel[o], count);
        const Floats weight = load_part(&eq.weight[o], count);
        const Floats value = load_part(&weighting.weighted[o], count) - weight * gather(weighting.mean.data(), texel);
        tile.add(flow_terms(s.by_x, s.by_y, s.x, s.y), weight * (1.0f - weight * gather(eq.mean_weight.data(), texel)),
                 value);
        if (tile.is_full()) tile.flush(sums);
    }
    tile.flush(sums);
    return sums;
}

// The same at frozen colours, with the cost.
struct FrozenSums {
    FlowSums flow;
    double cost = 0.0;
};
FrozenSums frozen_sums(const AlignmentProblem& problem, const AlignmentState& state,
                       const std::vector<float>& texel_color, const ObservationRun& run)
{
    const FramePicture picture = frame_picture(problem.scene, state, run.frame, problem.level);
    const auto projection = picture.projection(state.plane[run.plane]);
    const ColorWeight weight_of(problem);
    const Exposure& exposure = state.exposure[run.frame];
    const auto gain = static_cast<float>(exposure.gain), bias = static_cast<float>(exposure.bias);
    FrozenSums sums;
    FlowTile tile;
    Places places;
    for (std::size_t first = run.begin; first < run.end; first += kPlaces * kFloats) {
        const std::size_t end = std::min<std::size_t>(run.end, first + kPlaces * kFloats);
        for (std::size_t i = 0, o = first; o < end; ++i, o += kFloats)
            places[i] =
                picture.place(projection, problem.texels.p_world, load_part(&problem.observations.texel[o], end - o));
        Floats cost{};
        for (std::size_t i = 0, o = first; o < end; ++i, o += kFloats) {
            const SampleLanes s = picture.sample(places[i]);
            const Ints texel = load_part(&problem.observations.texel[o], end - o);
            const Floats residual = first_of(gain * s.value + bias - gather(texel_color.data(), texel), end - o);
            const Floats weight = first_of(weight_of(residual), end - o);
            cost += huber_cost(residual, weight_of.huber);
            tile.add(flow_terms(s.by_x, s.by_y, s.x, s.y), weight, weight * residual);
        }
        tile.flush(sums.flow);
        sums.cost += sum(cost);
    }
    return sums;
}

// The derivatives along F of a run's greys, weighted.
void multiply(const ColorEquations& eq, const ObservationRun& run, const Eigen::Matrix3d& F, float* weighted)
{
    const Eigen::Matrix<float, kFlow, 1> f = flow_vector(F).cast<float>();
    const GraySamples& samples = *eq.samples;
    for (std::size_t o = run.begin; o < run.end; o += kFloats) {
        const std::size_t count = run.end - o;
        const Floats x = load_part(&samples.x[o], count), y = load_part(&samples.y[o], count);
        const Floats away = f[6] * x + f[7] * y;
        const Floats moved_x = f[0] * x + f[1] * y + f[2] - x * away;
        const Floats moved_y = f[3] * x + f[4] * y + f[5] - y * away;
        const Floats value =
            load_part(&samples.by_x[o], count) * moved_x + load_part(&samples.by_y[o], count) * moved_y;
        store_part(load_part(&eq.weight[o], count) * value, &weighted[o], count);
    }
}

// The sum over a run of value h r^T, with the means of the texels taken off the values.
FlowVector centered_sum(const ColorEquations& eq, const ObservationRun& run, const float* weighted, const float* mean)
{
    FlowTerms sums{};
    const GraySamples& samples = *eq.samples;
    for (std::size_t o = run.begin; o < run.end; o += kFloats) {
        const std::size_t count = run.end - o;
        const Ints texel = load_part(&eq.problem->observations.texel[o], count);
        const Floats value = load_part(&weighted[o], count) - load_part(&eq.weight[o], count) * gather(mean, texel);
        const FlowTerms terms =
            flow_terms(value * load_part(&samples.by_x[o], count), value * load_part(&samples.by_y[o], count),
                       load_part(&samples.x[o], count), load_part(&samples.y[o], count));
        for (std::size_t i = 0; i < kFlow; ++i)
            sums[i] += terms[i];
    }
    FlowVector total;
    for (int i = 0; i < kFlow; ++i)
        total[i] = sum(sums[static_cast<std::size_t>(i)]);
    return total;
}

} // namespace

FrozenColors frozen_colors(const AlignmentProblem& problem, const AlignmentState& state,
                           const std::vector<float>& texel_color)
{
    const ObservationRuns& runs = problem.runs;
    const StepLayout layout{state.camera_from_world.size(), state.plane.size()};
    const CameraFlow camera = camera_flow(state.color);
    FrozenColors result{StepVector::Zero(layout.size()), {}, std::vector<PairCost>(runs.run.size())};
    Gradient gradient(layout.frames, runs.run.size());
    Blocks blocks(layout.frames, runs.run.size());
    for_each_run(runs, [&](const ObservationRun& run, std::uint32_t r) {
        const FrozenSums sums = frozen_sums(problem, state, texel_color, run);
        const PlaneFlow flow = flow_of(state, run);
        const double gain = state.exposure[run.frame].gain;
        gradient.set(run, r, flow, gain * sums.flow.first);
        blocks.set(run, r, flow, gain * gain * sums.flow.second);
        result.cost[r] = {run.frame, run.plane, sums.cost};
    });
    gradient.add_to(result.gradient, runs, layout, camera);
    result.blocks = blocks.sums(runs, layout, camera);
    return result;
}

void ColorEquations::add_product(const StepVector& x, StepVector& out) const
{
    const Observations& observations = problem->observations;
    const auto weighted = std::make_unique_for_overwrite<float[]>(weight.size());
    const auto mean = std::make_unique_for_overwrite<float[]>(mean_weight.size());
    parallel_for(layout.frames, [&](std::size_t k) {
        const CameraStep step = camera.step(x.segment<6>(layout.pose(k)), x.segment<9>(layout.calibration()));
        for (std::uint32_t r = problem->runs.first_of_frame[k]; r < problem->runs.first_of_frame[k + 1]; ++r) {
            const Vector3 by_plane = x.segment<3>(layout.plane(problem->runs.run[r].plane));
            multiply(*this, problem->runs.run[r], gain[k] * flow[r].flow(step, by_plane), weighted.get());
        }
    });
    const auto center = [&](std::size_t t) {
        float total = 0.0f;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
            total += weighted[observations.of_texel[i]];
        mean[t] = mean_weight[t] * total;
    };
    parallel_for(mean_weight.size(), center, kTexelGrain);
    Gradient result(layout.frames, problem->runs.run.size());
    for_each_run(problem->runs, [&](const ObservationRun& run, std::uint32_t r) {
        result.set(run, r, flow[r], gain[run.frame] * centered_sum(*this, run, weighted.get(), mean.get()));
    });
    result.add_to(out, problem->runs, layout, camera);
}

ColorEquations color_equations(const AlignmentProblem& problem, const Fit& fit)
{
    const AlignmentState& state = fit.state;
    const ObservationRuns& runs = problem.runs;
    ColorEquations eq;
    eq.problem = &problem;
    eq.samples = &fit.samples;
    eq.layout = {state.camera_from_world.size(), state.plane.size()};
    eq.camera = camera_flow(state.color);
    for (const Exposure& exposure : state.exposure)
        eq.gain.push_back(exposure.gain);
    eq.flow.resize(runs.run.size());
    const Weighting weighting = weigh(eq, fit);
    Gradient gradient(eq.layout.frames, runs.run.size());
    Blocks blocks(eq.layout.frames, runs.run.size());
    for_each_run(runs, [&](const ObservationRun& run, std::uint32_t r) {
        const FlowSums sums = centered_sums(eq, weighting, run);
        const double gain = eq.gain[run.frame];
        eq.flow[r] = flow_of(state, run);
        gradient.set(run, r, eq.flow[r], gain * sums.first);
        blocks.set(run, r, eq.flow[r], gain * gain * sums.second);
    });
    eq.gradient = StepVector::Zero(eq.layout.size());
    gradient.add_to(eq.gradient, runs, eq.layout, eq.camera);
    eq.blocks = blocks.sums(runs, eq.layout, eq.camera);
    return eq;
}

} // namespace quoin
