#include "alignment/solver.h"

#include "alignment/exposure.h"
#include "alignment/normal_equations.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr double kDampingFactor = 10.0;
constexpr double kMinDamping = 1e-9; // what a rejected Gauss-Newton step starts from

enum class Block { Pose, Plane, Calibration };

// The exposures that fit the greys of a state, if they lower its energy.
Fit with_better_exposures(const AlignmentProblem& problem, Fit current)
{
    auto exposure =
        estimate_exposures(problem.observations, current.samples.value, problem.scene.params, current.state.exposure);
    return with_exposures(problem, std::move(current), std::move(exposure));
}

// The best of the steps with rising damping, or the state itself. `damping` is left at what the next step should try.
Fit joint_step(const AlignmentProblem& problem, Fit current, double& damping)
{
    const OptimizeTextureParams& params = problem.scene.params;
    const auto equations = linearize(problem, current);
    for (int trial = 0; trial < params.damping_trials; ++trial) {
        Fit candidate = fit(
            problem, moved(current.state, solve_joint(equations, damping, params.cg_iterations, params.cg_tolerance)));
        if (candidate.energy.total() < current.energy.total()) {
            damping /= kDampingFactor;
            return candidate;
        }
        damping = std::max(damping, kMinDamping) * kDampingFactor;
    }
    return current;
}

bool has_fallen(double before, const Fit& after, const OptimizeTextureParams& params)
{
    return before - after.energy.total() > params.min_decrease * before;
}

void keep_only(StepVector& step, const StepLayout& layout, Block block)
{
    if (block != Block::Pose) step.head(layout.plane(0)).setZero();
    if (block != Block::Plane) step.segment(layout.plane(0), layout.calibration() - layout.plane(0)).setZero();
    if (block != Block::Calibration) step.tail<9>().setZero();
}

// A Gauss-Newton step of all blocks of one kind at frozen colours; each block whose energy does not fall is put back.
AlignmentState block_step(const AlignmentProblem& problem, const AlignmentState& state, const std::vector<float>& color,
                          Block block)
{
    FrozenColors colors = frozen_colors(problem, state, color);
    const BlockEnergies before = energies(problem, state, colors.cost);
    const auto equations = linearize(problem, state, std::move(colors));
    StepVector step = solve_blocks(equations, problem.scene.params.damping);
    keep_only(step, equations.layout, block);
    const BlockEnergies after = energies(problem, moved(state, step), color);
    const auto put_back = [&](Eigen::Index first, Eigen::Index size, double was, double is) {
        if (!(is < was)) step.segment(first, size).setZero();
    };
    if (block == Block::Pose)
        for (std::size_t k = 0; k < before.of_frame.size(); ++k)
            put_back(equations.layout.pose(k), 6, before.of_frame[k], after.of_frame[k]);
    if (block == Block::Plane)
        for (std::size_t p = 0; p < before.of_plane.size(); ++p)
            put_back(equations.layout.plane(p), 3, before.of_plane[p], after.of_plane[p]);
    const AlignmentState candidate = moved(state, step);
    return energies(problem, candidate, color).sum.total() < before.sum.total() ? candidate : state;
}

} // namespace

// Exposures hardly change with the poses: once a new estimate does not help, none is made for this problem any more.
AlignmentState minimize_jointly(const AlignmentProblem& problem, AlignmentState state)
{
    const OptimizeTextureParams& params = problem.scene.params;
    double damping = params.damping;
    bool exposures_settled = !params.optimize_exposure;
    Fit current = fit(problem, std::move(state));
    for (int i = 0; i < params.iterations; ++i) {
        const double before = current.energy.total();
        if (!exposures_settled) {
            current = with_better_exposures(problem, std::move(current));
            exposures_settled = !has_fallen(before, current, params);
        }
        current = joint_step(problem, std::move(current), damping);
        if (!has_fallen(before, current, params)) break;
    }
    return current.state;
}

AlignmentState minimize_alternating(const AlignmentProblem& problem, AlignmentState state,
                                    const OnIteration& on_iteration)
{
    const OptimizeTextureParams& params = problem.scene.params;
    Fit current = fit(problem, std::move(state));
    for (int i = 0; i < params.outer_loops; ++i) {
        const double before = current.energy.total();
        AlignmentState next = current.state;
        for (int loop = 0; loop < params.pose_loops; ++loop)
            next = block_step(problem, next, current.color, Block::Pose);
        for (int loop = 0; loop < params.plane_loops; ++loop)
            next = block_step(problem, next, current.color, Block::Plane);
        if (problem.color_camera_is_free) next = block_step(problem, next, current.color, Block::Calibration);
        current = fit(problem, std::move(next));
        if (params.optimize_exposure) current = with_better_exposures(problem, std::move(current));
        on_iteration(current.state);
        if (!has_fallen(before, current, params)) break;
    }
    return current.state;
}

} // namespace quoin
