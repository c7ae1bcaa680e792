#include "alignment/solver.h"

#include "alignment/exposure.h"
#include "alignment/normal_equations.h"
#include "alignment/photometric.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr double kDampingFactor = 10.0;
constexpr double kMinDamping = 1e-9; // what a rejected Gauss-Newton step starts from

enum class Block { Pose, Plane, Calibration };

std::vector<float> observed_grays(const AlignmentProblem& problem, const AlignmentState& state)
{
    AlignmentState uncorrected = state;
    std::ranges::fill(uncorrected.exposure, Exposure{});
    return corrected_grays(problem.scene, uncorrected, problem.texels, problem.observations, problem.level);
}

AlignmentState with_better_exposures(const AlignmentProblem& problem, AlignmentState state)
{
    if (!problem.scene.params.optimize_exposure) return state;
    AlignmentState candidate = state;
    candidate.exposure = estimate_exposures(problem.observations, observed_grays(problem, state), problem.scene.params);
    return energy(problem, candidate).total() < energy(problem, state).total() ? candidate : state;
}

// The best of the steps with rising damping, or the state itself. `damping` is left at what the next step should try.
AlignmentState joint_step(const AlignmentProblem& problem, const AlignmentState& state, double& damping)
{
    const OptimizeTextureParams& params = problem.scene.params;
    const double current = energy(problem, state).total();
    const auto equations = linearize(problem, state, best_colors(problem, state), TexelColors::Eliminated);
    for (int trial = 0; trial < params.damping_trials; ++trial) {
        const AlignmentState candidate =
            moved(state, solve_joint(equations, damping, params.cg_iterations, params.cg_tolerance));
        if (energy(problem, candidate).total() < current) {
            damping /= kDampingFactor;
            return candidate;
        }
        damping = std::max(damping, kMinDamping) * kDampingFactor;
    }
    return state;
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
    const auto equations = linearize(problem, state, color, TexelColors::Frozen);
    StepVector step = solve_blocks(equations, problem.scene.params.damping);
    keep_only(step, equations.layout, block);
    const BlockEnergies before = energies(problem, state, color), after = energies(problem, moved(state, step), color);
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

AlignmentState minimize_jointly(const AlignmentProblem& problem, AlignmentState state, const OnIteration& on_iteration)
{
    const OptimizeTextureParams& params = problem.scene.params;
    double damping = params.damping;
    double current = energy(problem, state).total();
    for (int i = 0; i < params.iterations; ++i) {
        state = joint_step(problem, with_better_exposures(problem, std::move(state)), damping);
        on_iteration(state);
        const double next = energy(problem, state).total();
        if (!(current - next > params.min_decrease * current)) break;
        current = next;
    }
    return state;
}

AlignmentState minimize_alternating(const AlignmentProblem& problem, AlignmentState state,
                                    const OnIteration& on_iteration)
{
    const OptimizeTextureParams& params = problem.scene.params;
    double current = energy(problem, state).total();
    for (int i = 0; i < params.outer_loops; ++i) {
        const auto color = best_colors(problem, state);
        for (int loop = 0; loop < params.pose_loops; ++loop)
            state = block_step(problem, state, color, Block::Pose);
        for (int loop = 0; loop < params.plane_loops; ++loop)
            state = block_step(problem, state, color, Block::Plane);
        if (params.calibration == CalibrationUse::Refine) state = block_step(problem, state, color, Block::Calibration);
        state = with_better_exposures(problem, std::move(state));
        on_iteration(state);
        const double next = energy(problem, state).total();
        if (!(current - next > params.min_decrease * current)) break;
        current = next;
    }
    return state;
}

} // namespace quoin
