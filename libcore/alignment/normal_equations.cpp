#include "alignment/normal_equations.h"

#include "base/parallel.h"

#include <cmath>

namespace quoin {
namespace {

constexpr std::size_t kCouplingGrain = 512;

void add_depths(NormalEquations& eq, const AlignmentState& state, const DepthSamples& samples, double weight)
{
    if (weight == 0.0) return;
    for (const PairBlock& block : depth_blocks(state, samples, eq.problem->scene.params.huber_depth)) {
        eq.pose_own[block.frame] += weight * block.H.topLeftCorner<6, 6>();
        eq.plane_own[block.plane] += weight * block.H.bottomRightCorner<3, 3>();
        eq.gradient.segment<6>(eq.layout.pose(block.frame)) += weight * block.g.head<6>();
        eq.gradient.segment<3>(eq.layout.plane(block.plane)) += weight * block.g.tail<3>();
        eq.depth.push_back({block.frame, block.plane, weight * block.H.topRightCorner<6, 3>()});
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
        eq.pose_own.push_back(problem.prior_weight[k] * block.H);
        eq.gradient.segment<6>(eq.layout.pose(k)) += problem.prior_weight[k] * block.g;
    }
    for (std::size_t p = 0; p < eq.layout.planes; ++p) {
        const PlaneBlock block = plane_block(problem.scatter[p], state.plane[p]);
        const double weight = plane_weight(problem, p);
        eq.plane_own.push_back(weight * block.H);
        eq.gradient.segment<3>(eq.layout.plane(p)) += weight * block.g;
    }
    const CalibrationBlock block = calibration_prior(params, state.color, problem.input.color);
    eq.calibration_prior = block.H;
    eq.gradient.segment<9>(eq.layout.calibration()) += block.g;
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

void add_depth_product(const NormalEquations& eq, const StepVector& x, StepVector& out)
{
    struct Product {
        Twist pose;
        Vector3 plane;
    };
    std::vector<Product> product(eq.depth.size());
    const auto multiply = [&](std::size_t i) {
        const DepthCoupling& pair = eq.depth[i];
        product[i].pose.noalias() = pair.H * x.segment<3>(eq.layout.plane(pair.plane));
        product[i].plane.noalias() = pair.H.transpose() * x.segment<6>(eq.layout.pose(pair.frame));
    };
    parallel_for(product.size(), multiply, kCouplingGrain);
    for (std::size_t i = 0; i < product.size(); ++i) {
        out.segment<6>(eq.layout.pose(eq.depth[i].frame)) += product[i].pose;
        out.segment<3>(eq.layout.plane(eq.depth[i].plane)) += product[i].plane;
    }
}

void clear_fixed(const NormalEquations& eq, StepVector& x)
{
    for (std::size_t k = 0; k < eq.layout.frames; ++k)
        if (!eq.problem->frame_is_free[k]) x.segment<6>(eq.layout.pose(k)).setZero();
    for (std::size_t p = 0; p < eq.layout.planes; ++p)
        if (!eq.problem->plane_is_free[p]) x.segment<3>(eq.layout.plane(p)).setZero();
    if (!eq.calibrate) x.segment<9>(eq.layout.calibration()).setZero();
}

NormalEquations without_colors(const AlignmentProblem& problem, const AlignmentState& state)
{
    const OptimizeTextureParams& params = problem.scene.params;
    NormalEquations eq;
    eq.problem = &problem;
    eq.layout = {state.camera_from_world.size(), state.plane.size()};
    eq.calibrate = problem.color_camera_is_free;
    add_priors(eq, state);
    add_depths(eq, state, problem.depths, problem.weight.depth);
    add_depths(eq, state, problem.line_depths, params.lambda_t);
    add_lines(eq, state);
    return eq;
}

void finish_gradient(NormalEquations& eq, const StepVector& of_colors)
{
    eq.gradient += of_colors;
    for (const WeightedLine& line : eq.line)
        scatter(eq.layout, line, line.row.residual, eq.gradient);
    clear_fixed(eq, eq.gradient);
}

void finish_blocks(NormalEquations& eq, ColorBlocks color)
{
    eq.pose_block = std::move(color.pose);
    eq.plane_block = std::move(color.plane);
    eq.calibration_block = color.calibration + eq.calibration_prior;
    for (std::size_t k = 0; k < eq.layout.frames; ++k)
        eq.pose_block[k] += eq.pose_own[k];
    for (std::size_t p = 0; p < eq.layout.planes; ++p)
        eq.plane_block[p] += eq.plane_own[p];
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

NormalEquations linearize(const AlignmentProblem& problem, const Fit& fit)
{
    NormalEquations eq = without_colors(problem, fit.state);
    eq.color = color_equations(problem, fit);
    finish_gradient(eq, eq.color.gradient);
    finish_blocks(eq, std::move(eq.color.blocks));
    return eq;
}

NormalEquations linearize(const AlignmentProblem& problem, const AlignmentState& state, FrozenColors colors)
{
    NormalEquations eq = without_colors(problem, state);
    finish_gradient(eq, colors.gradient);
    finish_blocks(eq, std::move(colors.blocks));
    return eq;
}

StepVector NormalEquations::apply(const StepVector& x) const
{
    StepVector out = StepVector::Zero(layout.size());
    color.add_product(x, out);
    add_depth_product(*this, x, out);
    for (const WeightedLine& weighted : line)
        scatter(layout, weighted, product(layout, weighted, x), out);
    for (std::size_t k = 0; k < layout.frames; ++k)
        out.segment<6>(layout.pose(k)) += pose_own[k] * x.segment<6>(layout.pose(k));
    for (std::size_t p = 0; p < layout.planes; ++p)
        out.segment<3>(layout.plane(p)) += plane_own[p] * x.segment<3>(layout.plane(p));
    out.segment<9>(layout.calibration()) += calibration_prior * x.segment<9>(layout.calibration());
    clear_fixed(*this, out);
    return out;
}

} // namespace quoin
