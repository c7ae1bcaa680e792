#include "alignment/normal_equations.h"

#include "alignment/photometric.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace quoin {
namespace {

constexpr std::size_t kTexelGrain = 4096;

using Vector9f = Eigen::Matrix<float, 9, 1>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

void find_runs(NormalEquations& eq)
{
    const Observations& observations = eq.problem->observations;
    const Texels& texels = eq.problem->texels;
    eq.first_run_of_frame.push_back(0);
    for (std::uint32_t k = 0; k < eq.layout.frames; ++k) {
        for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
            const PlaneId plane = texels.plane[observations.texel[o]];
            const bool starts = eq.run.size() == eq.first_run_of_frame.back() || eq.run.back().plane != plane;
            if (starts) eq.run.push_back({k, o, o, plane});
            eq.run.back().end = o + 1;
        }
        eq.first_run_of_frame.push_back(static_cast<std::uint32_t>(eq.run.size()));
    }
    eq.first_run_of_plane.assign(eq.layout.planes + 1, 0);
    for (const ObservationRun& run : eq.run)
        ++eq.first_run_of_plane[run.plane + 1];
    std::partial_sum(eq.first_run_of_plane.begin(), eq.first_run_of_plane.end(), eq.first_run_of_plane.begin());
    eq.run_of_plane.resize(eq.run.size());
    auto next = eq.first_run_of_plane;
    for (std::uint32_t r = 0; r < eq.run.size(); ++r)
        eq.run_of_plane[next[eq.run[r].plane]++] = r;
}

// Rows of one frame; share holds the square root of the weight until it is known for all views of a texel.
void linearize_frame(NormalEquations& eq, const AlignmentState& state, const std::vector<float>& texel_color,
                     std::size_t k)
{
    const AlignmentProblem& problem = *eq.problem;
    const OptimizeTextureParams& params = problem.scene.params;
    const FrameSampler frame = frame_sampler(problem.scene, state, k, problem.level);
    for (std::uint32_t r = eq.first_run_of_frame[k]; r < eq.first_run_of_frame[k + 1]; ++r) {
        const CenteredPlane& plane = state.plane[eq.run[r].plane];
        const TangentBasis tangents = plane.tangents();
        for (std::uint32_t o = eq.run[r].begin; o < eq.run[r].end; ++o) {
            const TexelId t = problem.observations.texel[o];
            const auto row = photometric_row(frame, plane, tangents, problem.texels.p_world[t].cast<double>());
            const double residual = row.value - texel_color[t];
            const double weight = std::sqrt(huber_weight(residual, params.huber_color)) / params.sigma_color;
            Vector9 J;
            J.head<6>() = row.pose;
            J.tail<3>() = row.plane;
            eq.row[o] = (weight * J).cast<float>();
            if (eq.calibrate) eq.calibration_row[o] = (weight * row.calibration).cast<float>();
            eq.residual[o] = static_cast<float>(weight * residual);
            eq.share[o] = static_cast<float>(weight);
        }
    }
}

// Takes the part out of the rows' values that a change of the texels' colours explains.
void center(const NormalEquations& eq, std::vector<float>& values)
{
    if (eq.colors == TexelColors::Frozen) return;
    const Observations& observations = eq.problem->observations;
    parallel_for(
        eq.problem->texels.size(),
        [&](std::size_t t) {
            float along = 0.0f;
            for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
                along += eq.share[observations.of_texel[i]] * values[observations.of_texel[i]];
            for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
                values[observations.of_texel[i]] -= eq.share[observations.of_texel[i]] * along;
        },
        kTexelGrain);
}

void set_shares(NormalEquations& eq)
{
    const Observations& observations = eq.problem->observations;
    if (eq.colors == TexelColors::Frozen) {
        std::ranges::fill(eq.share, 0.0f);
        return;
    }
    parallel_for(
        eq.problem->texels.size(),
        [&](std::size_t t) {
            float square = 0.0f;
            for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
                square += eq.share[observations.of_texel[i]] * eq.share[observations.of_texel[i]];
            if (square <= 0.0f) return;
            for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i)
                eq.share[observations.of_texel[i]] /= std::sqrt(square);
        },
        kTexelGrain);
}

void linearize_colors(NormalEquations& eq, const AlignmentState& state, const std::vector<float>& texel_color)
{
    const std::size_t count = eq.problem->observations.size();
    eq.row.resize(count);
    eq.calibration_row.resize(eq.calibrate ? count : 0);
    eq.residual.resize(count);
    eq.share.resize(count);
    parallel_for(eq.layout.frames, [&](std::size_t k) { linearize_frame(eq, state, texel_color, k); });
    set_shares(eq);
    center(eq, eq.residual);
}

void add_depth_blocks(NormalEquations& eq, const AlignmentState& state, const DepthSamples& samples, double weight)
{
    if (weight == 0.0 || samples.sample.empty()) return;
    for (PairBlock& block : depth_blocks(state, samples, eq.problem->scene.params.huber_depth)) {
        block.H *= weight;
        block.g *= weight;
        eq.depth.push_back(block);
    }
}

void add_lines(NormalEquations& eq, const AlignmentState& state)
{
    const OptimizeTextureParams& params = eq.problem->scene.params;
    if (params.lambda_t == 0.0) return;
    for (const LineObservation& line : eq.problem->lines)
        for (const std::size_t end : {0, 1}) {
            LineRow row = line_row(state, line, end);
            const double weight =
                std::sqrt(params.lambda_t * huber_weight(row.residual / params.sigma_line, params.huber_line)) /
                params.sigma_line;
            row.residual *= weight;
            row.pose *= weight;
            for (Vector3& by_plane : row.plane)
                by_plane *= weight;
            row.calibration *= weight;
            eq.line.push_back({&line, row});
        }
}

// Terms in one unknown block: plane term, pose prior and calibration prior. They begin gradient and diagonal.
void add_priors(NormalEquations& eq, const AlignmentState& state)
{
    const AlignmentProblem& problem = *eq.problem;
    const OptimizeTextureParams& params = problem.scene.params;
    const PosePrior prior = pose_prior(params);
    eq.gradient = StepVector::Zero(eq.layout.size());
    for (std::size_t k = 0; k < eq.layout.frames; ++k) {
        const PoseBlock block = prior_block(prior, state.camera_from_world[k], problem.input.camera_from_world[k]);
        eq.pose_prior.push_back(problem.prior_weight[k] * block.H);
        eq.gradient.segment<6>(eq.layout.pose(k)) += problem.prior_weight[k] * block.g;
    }
    const double weight = problem.lambda_p / (params.sigma_plane * params.sigma_plane);
    for (std::size_t p = 0; p < eq.layout.planes; ++p) {
        const PlaneBlock block = plane_block(problem.scatter[p], state.plane[p]);
        eq.plane_prior.push_back(weight * block.H);
        eq.gradient.segment<3>(eq.layout.plane(p)) += weight * block.g;
    }
    const CalibrationBlock block = calibration_prior(params, state.color, problem.input.color);
    eq.calibration_prior = block.H;
    eq.gradient.segment<9>(eq.layout.calibration()) += block.g;
}

// Adds J^T values over the colour rows: per frame, and per run for its plane, reduced in order.
void scatter_colors(const NormalEquations& eq, const std::vector<float>& values, StepVector& out)
{
    std::vector<Vector3> of_run(eq.run.size(), Vector3::Zero());
    std::vector<Vector9> of_frame(eq.calibrate ? eq.layout.frames : 0, Vector9::Zero());
    parallel_for(eq.layout.frames, [&](std::size_t k) {
        for (std::uint32_t r = eq.first_run_of_frame[k]; r < eq.first_run_of_frame[k + 1]; ++r) {
            Vector9 sum = Vector9::Zero();
            for (std::uint32_t o = eq.run[r].begin; o < eq.run[r].end; ++o) {
                sum += (values[o] * eq.row[o]).cast<double>();
                if (eq.calibrate) of_frame[k] += (values[o] * eq.calibration_row[o]).cast<double>();
            }
            out.segment<6>(eq.layout.pose(k)) += sum.head<6>();
            of_run[r] = sum.tail<3>();
        }
    });
    for (std::size_t p = 0; p < eq.layout.planes; ++p)
        for (std::uint32_t i = eq.first_run_of_plane[p]; i < eq.first_run_of_plane[p + 1]; ++i)
            out.segment<3>(eq.layout.plane(p)) += of_run[eq.run_of_plane[i]];
    for (const Vector9& part : of_frame)
        out.segment<9>(eq.layout.calibration()) += part;
}

std::vector<float> color_products(const NormalEquations& eq, const StepVector& x)
{
    std::vector<float> values(eq.row.size());
    const Vector9f by_calibration = x.segment<9>(eq.layout.calibration()).cast<float>();
    parallel_for(eq.layout.frames, [&](std::size_t k) {
        Vector9f step;
        step.head<6>() = x.segment<6>(eq.layout.pose(k)).cast<float>();
        for (std::uint32_t r = eq.first_run_of_frame[k]; r < eq.first_run_of_frame[k + 1]; ++r) {
            step.tail<3>() = x.segment<3>(eq.layout.plane(eq.run[r].plane)).cast<float>();
            for (std::uint32_t o = eq.run[r].begin; o < eq.run[r].end; ++o)
                values[o] = eq.row[o].dot(step) + (eq.calibrate ? eq.calibration_row[o].dot(by_calibration) : 0.0f);
        }
    });
    return values;
}

double product(const StepLayout& layout, const WeightedLine& line, const StepVector& x)
{
    double sum = line.row.pose.dot(x.segment<6>(layout.pose(line.line->frame)));
    for (const std::size_t i : {0, 1})
        sum += line.row.plane[i].dot(x.segment<3>(layout.plane(line.line->plane[i])));
    return sum + line.row.calibration.dot(x.segment<9>(layout.calibration()));
}

void scatter(const StepLayout& layout, const WeightedLine& line, double value, StepVector& out)
{
    out.segment<6>(layout.pose(line.line->frame)) += value * line.row.pose;
    for (const std::size_t i : {0, 1})
        out.segment<3>(layout.plane(line.line->plane[i])) += value * line.row.plane[i];
    out.segment<9>(layout.calibration()) += value * line.row.calibration;
}

void clear_fixed(const NormalEquations& eq, StepVector& x)
{
    for (std::size_t k = 0; k < eq.layout.frames; ++k)
        if (!eq.problem->frame_is_free[k]) x.segment<6>(eq.layout.pose(k)).setZero();
    for (std::size_t p = 0; p < eq.layout.planes; ++p)
        if (!eq.problem->plane_is_free[p]) x.segment<3>(eq.layout.plane(p)).setZero();
    if (!eq.calibrate) x.segment<9>(eq.layout.calibration()).setZero();
}

void finish_gradient(NormalEquations& eq)
{
    scatter_colors(eq, eq.residual, eq.gradient);
    for (const PairBlock& block : eq.depth) {
        eq.gradient.segment<6>(eq.layout.pose(block.frame)) += block.g.head<6>();
        eq.gradient.segment<3>(eq.layout.plane(block.plane)) += block.g.tail<3>();
    }
    for (const WeightedLine& line : eq.line)
        scatter(eq.layout, line, line.row.residual, eq.gradient);
    clear_fixed(eq, eq.gradient);
}

// Diagonal blocks of the colour rows. Centring takes share^2 off each view; the coupling of views of one plane or of
// the camera through the colours is left to the conjugate gradients.
void add_color_blocks(NormalEquations& eq)
{
    std::vector<Eigen::Matrix3d> of_run(eq.run.size(), Eigen::Matrix3d::Zero());
    std::vector<Matrix9> of_frame(eq.calibrate ? eq.layout.frames : 0, Matrix9::Zero());
    parallel_for(eq.layout.frames, [&](std::size_t k) {
        for (std::uint32_t r = eq.first_run_of_frame[k]; r < eq.first_run_of_frame[k + 1]; ++r) {
            Matrix9 sum = Matrix9::Zero();
            for (std::uint32_t o = eq.run[r].begin; o < eq.run[r].end; ++o) {
                const double weight = 1.0 - eq.share[o] * eq.share[o];
                const Vector9 J = eq.row[o].cast<double>();
                sum.noalias() += weight * J * J.transpose();
                if (!eq.calibrate) continue;
                const Vector9 J_c = eq.calibration_row[o].cast<double>();
                of_frame[k].noalias() += weight * J_c * J_c.transpose();
            }
            eq.pose_block[k] += sum.topLeftCorner<6, 6>();
            of_run[r] = sum.bottomRightCorner<3, 3>();
        }
    });
    for (std::size_t r = 0; r < eq.run.size(); ++r)
        eq.plane_block[eq.run[r].plane] += of_run[r];
    for (const Matrix9& part : of_frame)
        eq.calibration_block += part;
}

void finish_blocks(NormalEquations& eq)
{
    eq.pose_block = eq.pose_prior;
    eq.plane_block = eq.plane_prior;
    eq.calibration_block = eq.calibration_prior;
    add_color_blocks(eq);
    for (const PairBlock& block : eq.depth) {
        eq.pose_block[block.frame] += block.H.topLeftCorner<6, 6>();
        eq.plane_block[block.plane] += block.H.bottomRightCorner<3, 3>();
    }
    for (const WeightedLine& line : eq.line) {
        eq.pose_block[line.line->frame] += line.row.pose * line.row.pose.transpose();
        for (const std::size_t i : {0, 1})
            eq.plane_block[line.line->plane[i]] += line.row.plane[i] * line.row.plane[i].transpose();
        eq.calibration_block += line.row.calibration * line.row.calibration.transpose();
    }
    for (std::size_t k = 0; k < eq.layout.frames; ++k)
        if (!eq.problem->frame_is_free[k]) eq.pose_block[k].setIdentity();
    for (std::size_t p = 0; p < eq.layout.planes; ++p)
        if (!eq.problem->plane_is_free[p]) eq.plane_block[p].setIdentity();
    if (!eq.calibrate) eq.calibration_block.setIdentity();
}

} // namespace

AlignmentState moved(const AlignmentState& state, const StepVector& step)
{
    const StepLayout layout{state.camera_from_world.size(), state.plane.size()};
    AlignmentState result = state;
    for (std::size_t k = 0; k < layout.frames; ++k) {
        const Twist twist = step.segment<6>(layout.pose(k));
        if (!twist.isZero(0.0)) result.camera_from_world[k] = moved(state.camera_from_world[k], twist);
    }
    for (std::size_t p = 0; p < layout.planes; ++p) {
        const Vector3 by = step.segment<3>(layout.plane(p));
        if (!by.isZero(0.0)) result.plane[p] = state.plane[p].moved(by);
    }
    const CalibrationStep calibration = step.segment<9>(layout.calibration());
    if (!calibration.isZero(0.0)) result.color = state.color.moved(calibration);
    return result;
}

NormalEquations linearize(const AlignmentProblem& problem, const AlignmentState& state,
                          const std::vector<float>& texel_color, TexelColors colors)
{
    const OptimizeTextureParams& params = problem.scene.params;
    NormalEquations eq;
    eq.problem = &problem;
    eq.layout = {state.camera_from_world.size(), state.plane.size()};
    eq.colors = colors;
    eq.calibrate = problem.color_camera_is_free;
    find_runs(eq);
    linearize_colors(eq, state, texel_color);
    add_depth_blocks(eq, state, problem.depths, params.lambda_d);
    add_depth_blocks(eq, state, problem.line_depths, params.lambda_t);
    add_lines(eq, state);
    add_priors(eq, state);
    finish_gradient(eq);
    finish_blocks(eq);
    return eq;
}

StepVector NormalEquations::apply(const StepVector& x) const
{
    StepVector out = StepVector::Zero(layout.size());
    std::vector<float> values = color_products(*this, x);
    center(*this, values);
    scatter_colors(*this, values, out);
    for (const PairBlock& block : depth) {
        Vector9 pair;
        pair.head<6>() = x.segment<6>(layout.pose(block.frame));
        pair.tail<3>() = x.segment<3>(layout.plane(block.plane));
        const Vector9 product = block.H * pair;
        out.segment<6>(layout.pose(block.frame)) += product.head<6>();
        out.segment<3>(layout.plane(block.plane)) += product.tail<3>();
    }
    for (const WeightedLine& weighted : line)
        scatter(layout, weighted, product(layout, weighted, x), out);
    for (std::size_t k = 0; k < layout.frames; ++k)
        out.segment<6>(layout.pose(k)) += pose_prior[k] * x.segment<6>(layout.pose(k));
    for (std::size_t p = 0; p < layout.planes; ++p)
        out.segment<3>(layout.plane(p)) += plane_prior[p] * x.segment<3>(layout.plane(p));
    out.segment<9>(layout.calibration()) += calibration_prior * x.segment<9>(layout.calibration());
    clear_fixed(*this, out);
    return out;
}

} // namespace quoin
