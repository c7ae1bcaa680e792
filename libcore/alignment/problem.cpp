#include "alignment/problem.h"

#include "alignment/held_out.h"
#include "alignment/selection.h"

#include <algorithm>

namespace quoin {
namespace {

// Observed texels and depths of every frame.
std::vector<std::uint32_t> observation_counts(const AlignmentProblem& problem)
{
    const std::vector<std::uint32_t>& first = problem.observations.first_of_frame;
    std::vector<std::uint32_t> counts(problem.scene.frames(), 0);
    for (std::size_t k = 0; k < counts.size(); ++k)
        counts[k] = first[k + 1] - first[k];
    if (problem.scene.params.lambda_d > 0.0)
        for (const ObservationRun& run : problem.depths.run)
            counts[run.frame] += run.end - run.begin;
    return counts;
}

std::vector<std::uint8_t> free_frames(const AlignmentProblem& problem, const std::vector<std::uint32_t>& observations)
{
    const OptimizeTextureParams& params = problem.scene.params;
    std::vector<std::uint8_t> is_free(problem.scene.frames(), 0);
    for (std::size_t k = 0; k < is_free.size() && params.optimize_poses; ++k)
        is_free[k] = observations[k] >= static_cast<std::uint32_t>(params.min_observations);
    return is_free;
}

std::vector<double> prior_weights(const AlignmentProblem& problem, const std::vector<std::uint32_t>& observations)
{
    std::vector<double> weights;
    for (const std::uint32_t count : observations)
        weights.push_back(std::max(1.0, count / problem.scene.params.shared_errors));
    return weights;
}

std::vector<std::uint8_t> free_planes(const AlignmentProblem& problem)
{
    const OptimizeTextureParams& params = problem.scene.params;
    std::vector<std::uint32_t> count(problem.scatter.size(), 0);
    for (const TexelId t : problem.observations.texel)
        ++count[problem.texels.plane[t]];
    if (params.lambda_d > 0.0)
        for (const ObservationRun& run : problem.depths.run)
            count[run.plane] += run.end - run.begin;
    std::vector<std::uint8_t> is_free(count.size(), 0);
    for (std::size_t p = 0; p < count.size() && params.optimize_planes; ++p)
        is_free[p] =
            problem.scatter[p].weight > 0.0 && count[p] >= static_cast<std::uint32_t>(params.min_plane_observations);
    return is_free;
}

Texels fitted(const Texels& texels, const OptimizeTextureParams& params)
{
    auto keep = held_out_texels(texels, params);
    for (std::uint8_t& k : keep)
        k = k == 0;
    return kept(texels, keep);
}

} // namespace

AlignmentState input_state(const Scan& scan, const Keyframes& keyframes, const PlaneMesh& mesh)
{
    AlignmentState state;
    for (const FrameId id : keyframes.frame)
        state.camera_from_world.push_back(scan.frames[id].camera_from_world);
    for (std::size_t p = 0; p < mesh.plane.size(); ++p)
        state.plane.push_back(centered(mesh.plane[p], mesh.moments[p].centroid()));
    state.exposure.resize(keyframes.frame.size());
    state.color = {scan.color, scan.depth_from_color.inverse()};
    return state;
}

ProblemSource problem_source(const AlignmentScene& scene, const Keyframes& keyframes, const LineMatches& lines,
                             const AlignmentState& input)
{
    ProblemSource source{scene,
                         input,
                         scene.params.lambda_p,
                         sample_depths(scene, input),
                         {},
                         {},
                         scene.params.calibration != CalibrationUse::Fixed};
    if (scene.params.line_term == LineTermKind::Reprojection)
        source.lines = line_observations(scene, input, keyframes, lines);
    else
        source.line_depths = line_depths(scene, input, keyframes, lines);
    return source;
}

AlignmentProblem make_problem(const ProblemSource& source, const AlignmentState& state, int level, double spacing,
                              TexelChoice choice)
{
    const AlignmentScene& scene = source.scene;
    AlignmentProblem problem{scene, level,           sample_texels(scene.mesh, spacing), {},           {}, {}, {}, {},
                             {},    source.lambda_p, given_weights(scene.params),        source.input, {}, {}, {}};
    problem.scatter = scene.params.plane_term == PlaneTermKind::Moments ? scatters_of_moments(scene.mesh, spacing)
                                                                        : scatters_of_texels(problem.texels);
    if (choice != TexelChoice::All) problem.texels = fitted(problem.texels, scene.params);
    problem.observations = observe(scene, state, problem.texels, level);
    if (choice == TexelChoice::Selected) {
        const auto keep = select_texels(scene, state, problem.texels, problem.observations, level);
        problem.texels = kept(problem.texels, keep);
        problem.observations = kept(problem.observations, keep);
    }
    problem.runs = runs_of(problem.observations, problem.texels);
    problem.depths = source.depths;
    problem.lines = lines_within(source.lines, state, scene.params.max_line_distance);
    problem.line_depths = source.line_depths;
    const auto counts = observation_counts(problem);
    problem.frame_is_free = free_frames(problem, counts);
    problem.prior_weight = prior_weights(problem, counts);
    problem.plane_is_free = free_planes(problem);
    problem.color_camera_is_free = source.color_camera_is_free;
    return problem;
}

} // namespace quoin
