#include "alignment/optimize_texture.h"

#include "alignment/channel_exposure.h"
#include "alignment/data_weights.h"
#include "alignment/gauge.h"
#include "alignment/held_out.h"
#include "alignment/problem.h"
#include "alignment/selection.h"
#include "alignment/solver.h"
#include "alignment/vignetting.h"
#include "base/error.h"
#include "base/log.h"
#include "base/progress.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace quoin {
namespace {

constexpr int kReferenceStride = 4; // the fixed set that energies are reported on is this much sparser than the texels
constexpr int kMinLevelSize = 24;   // [px]; smaller images show nothing to align

void check(const OptimizeTextureParams& params)
{
    if (params.min_depth >= params.max_depth)
        throw UsageError(
            fmt::format("min_depth ({} m) must be smaller than max_depth ({} m)", params.min_depth, params.max_depth));
}

OptimizeTextureParams with_usable_levels(OptimizeTextureParams params, const Camera& camera)
{
    if (params.solver == AlignmentSolver::Alternating) params.levels = 1;
    while (params.levels > 1 && std::min(camera.width, camera.height) >> (params.levels - 1) < kMinLevelSize)
        --params.levels;
    return params;
}

double level_spacing(const OptimizeTextureParams& params, int level)
{
    return params.texel_size * params.texel_stride * (1 << level);
}

// lambda_p, or with PlaneWeight::Balanced lambda_p E_c / E_p of the input.
double balanced_weight(const AlignmentProblem& reference, const AlignmentState& state)
{
    const OptimizeTextureParams& params = reference.scene.params;
    if (params.plane_weight == PlaneWeight::Fixed) return params.lambda_p;
    AlignmentProblem unit = reference;
    unit.lambda_p = 1.0;
    const Energy start = fit(unit, state).energy;
    return start.plane > 0.0 ? params.lambda_p * start.color / start.plane : params.lambda_p;
}

// Mean costs over the fixed set, in the order of kEnergyNames.
const std::vector<std::string> kEnergyNames{"total", "color", "plane", "line", "depth", "prior"};

std::vector<double> mean_energies(const AlignmentProblem& reference, const AlignmentState& state)
{
    const Energy e = fit(reference, state).energy;
    const auto mean = [](double sum, double count) { return count > 0.0 ? sum / count : 0.0; };
    double points = 0.0;
    for (const PlaneScatter& scatter : reference.scatter)
        points += scatter.weight;
    const auto colors = static_cast<double>(reference.observations.size());
    const auto depths = static_cast<double>(reference.depths.size());
    const auto lines = static_cast<double>(2 * reference.lines.size() + reference.line_depths.size());
    const auto frames = static_cast<double>(reference.scene.frames());
    return {mean(e.total(), colors + depths + lines),
            mean(e.color, colors),
            mean(e.plane, points),
            mean(e.line, lines),
            mean(e.depth, depths),
            mean(e.prior, frames)};
}

// A colour camera that the scan describes well is better left alone: a few frames from nearly one place let it drift to
// where the colours hardly agree better. Tried on small images: is the mean cost of an observation, which is 1 where it
// is off by what is expected of it, lower by kWorthRefining of that and its own? Leaves the answer in the problem, and
// returns what came of it.
AlignmentState minimize_by_better_camera(AlignmentProblem& problem, const AlignmentState& state)
{
    constexpr double kWorthRefining = 0.1;
    const auto minimum = [&](bool is_free) {
        problem.color_camera_is_free = is_free;
        return fit(problem, minimize_jointly(problem, state));
    };
    Fit refined = minimum(true), as_given = minimum(false);
    const auto count = static_cast<double>(std::max<std::size_t>(1, problem.observations.size()));
    const double cost_refined = refined.energy.color / count, cost_as_given = as_given.energy.color / count;
    log_debug(fmt::format("mean colour cost {:.4g} with the colour camera refined, {:.4g} as given", cost_refined,
                          cost_as_given));
    problem.color_camera_is_free = cost_as_given - cost_refined > kWorthRefining * (1.0 + cost_as_given);
    return problem.color_camera_is_free ? std::move(refined.state) : std::move(as_given.state);
}

DataWeights weights_at(const AlignmentProblem& problem, const AlignmentState& state)
{
    const OptimizeTextureParams& params = problem.scene.params;
    const bool estimates = params.estimate_noise && params.solver == AlignmentSolver::Joint;
    return estimates ? estimated_weights(problem, state) : given_weights(params);
}

AlignmentState minimize_by_schedule(ProblemSource& source, AlignmentState state, const OnIteration& on_iteration)
{
    const OptimizeTextureParams& params = source.scene.params;
    if (params.calibration == CalibrationUse::Auto) {
        auto trial = make_problem(source, state, 0, level_spacing(params, 0), TexelChoice::Selected);
        minimize_by_better_camera(trial, state);
        source.color_camera_is_free = trial.color_camera_is_free;
    }
    const auto problem = make_problem(source, state, 0, level_spacing(params, 0), TexelChoice::Fitted);
    return minimize_alternating(problem, std::move(state), on_iteration);
}

// From coarse to fine, each level some rounds.
AlignmentState minimize_by_pyramid(ProblemSource& source, AlignmentState state, const OnIteration& on_round)
{
    const OptimizeTextureParams& params = source.scene.params;
    Progress progress("aligning", static_cast<std::size_t>(params.levels * params.visibility_rounds));
    bool tries_camera = params.calibration == CalibrationUse::Auto, is_aligned = false;
    for (int level = params.levels - 1; level >= 0; --level)
        for (int round = 0; round < params.visibility_rounds; ++round) {
            auto problem = make_problem(source, state, level, level_spacing(params, level), TexelChoice::Selected);
            if (is_aligned) problem.weight = weights_at(problem, state);
            log_debug(fmt::format("level {} compares {} texels in {} observations, {} depths and {} lines, noise of "
                                  "a grey {:.4f}, weight of the depths {:.3g}",
                                  level, problem.texels.size(), problem.observations.size(), problem.depths.size(),
                                  problem.lines.size(), 1.0 / std::sqrt(problem.weight.color), problem.weight.depth));
            state =
                tries_camera ? minimize_by_better_camera(problem, state) : minimize_jointly(problem, std::move(state));
            source.color_camera_is_free = problem.color_camera_is_free;
            tries_camera = false;
            is_aligned = true;
            on_round(state);
            progress.step();
        }
    return state;
}

bool moved_too_far(const Rigid& from, const Rigid& to, const OptimizeTextureParams& params)
{
    const Vector3 shift = to.inverse().translation() - from.inverse().translation();
    const double angle = rotation_angle(to.linear() * from.linear().transpose());
    return !(shift.norm() <= params.max_translation) || !(angle <= params.max_rotation * std::numbers::pi / 180.0);
}

// Puts back the frames that went astray: moved beyond belief, or worse on the fixed set than before.
AlignmentState without_strays(const AlignmentProblem& reference, const AlignmentState& input, AlignmentState state)
{
    const OptimizeTextureParams& params = reference.scene.params;
    const auto of_blocks = [&](const Fit& f) { return energies(reference, f.state, f.color); };
    const BlockEnergies before = of_blocks(fit(reference, input)), after = of_blocks(fit(reference, state));
    std::size_t strays = 0;
    for (std::size_t k = 0; k < state.camera_from_world.size(); ++k) {
        const bool worse = after.of_frame[k] > (1.0 + params.max_increase) * before.of_frame[k];
        if (!worse && !moved_too_far(input.camera_from_world[k], state.camera_from_world[k], params)) continue;
        state.camera_from_world[k] = input.camera_from_world[k];
        state.exposure[k] = {};
        ++strays;
    }
    if (strays > 0)
        log_warning(fmt::format("{} of {} keyframes could not be aligned and keep their input pose", strays,
                                state.camera_from_world.size()));
    return state;
}

// Photographs and depths do not tell where the whole lies: it goes back onto the dense mesh. Frames that see nothing
// stay.
AlignmentState in_frame_of_mesh(const AlignmentProblem& reference, const AlignmentState& input, AlignmentState state)
{
    const OptimizeTextureParams& params = reference.scene.params;
    const bool any_moves = std::ranges::count(reference.frame_is_free, 0) < std::ssize(reference.frame_is_free);
    if (!params.keep_frame || !params.optimize_poses || !params.optimize_planes || !any_moves) return state;
    state = returned_to_mesh(std::move(state), reference.scatter);
    for (std::size_t k = 0; k < state.camera_from_world.size(); ++k)
        if (!reference.frame_is_free[k]) state.camera_from_world[k] = input.camera_from_world[k];
    return state;
}

// Puts back the normals that went astray: turned beyond belief, and by it out of the dense cluster. Large planes turn
// little, as cameras do; strips that round a crease off may turn over to one of its sides.
AlignmentState without_stray_normals(const AlignmentProblem& reference, const AlignmentState& input,
                                     AlignmentState state)
{
    const OptimizeTextureParams& params = reference.scene.params;
    const double least_cosine = std::cos(params.max_rotation * std::numbers::pi / 180.0);
    std::size_t strays = 0;
    for (std::size_t p = 0; p < state.plane.size(); ++p) {
        const PlaneScatter& cluster = reference.scatter[p];
        const auto sum = [&](const Vector3& n) { return n.dot(cluster.scatter * n); }; // of squared distances
        const Vector3 &was = input.plane[p].normal, &is = state.plane[p].normal;
        const double tilt = sum(is) - sum(was), max_tilt = params.max_tilt * params.max_tilt * cluster.weight;
        if (is.dot(was) >= least_cosine || tilt <= max_tilt) continue;
        state.plane[p].normal = was;
        ++strays;
    }
    if (strays > 0) log_info(fmt::format("{} of {} planes keep their input normal", strays, state.plane.size()));
    return state;
}

// As far as it shows at the poses of the input, which it hardly depends on; in the end it is estimated anew.
void take_out_vignetting(AlignmentScene& scene, const AlignmentProblem& reference, const AlignmentState& start)
{
    const Observations& observations = reference.observations;
    const std::array observed{
        sample_grays(scene, start, {reference.texels, observations, reference.runs}, reference.level).value};
    const auto radius = squared_radii(scene, start, reference.texels, observations);
    correct(scene, estimate_vignetting(observations, radius, observed, start.exposure, scene.params));
}

void warn_of_blind_frames(const AlignmentProblem& reference)
{
    const auto blind = std::ranges::count(reference.frame_is_free, 0);
    if (blind > 0 && reference.scene.params.optimize_poses)
        log_warning(fmt::format("{} of {} keyframes see too little of the planes and keep their input pose", blind,
                                reference.scene.frames()));
}

void warn_of_missing_texture(const AlignmentProblem& reference, const AlignmentState& start)
{
    const OptimizeTextureParams& params = reference.scene.params;
    const Textured textured = textured_texels(reference.scene, start, reference.texels, reference.observations);
    log_debug(fmt::format("{} of {} texels show a gradient", textured.textured, textured.seen));
    if (reference.scene.frames() < 2 || !params.optimize_poses || !textured.is_at_most(params.min_texture)) return;
    log_warning(
        fmt::format("next to no texture to align by: of {} points that two photographs see, neither black nor "
                    "white, {} have a gradient of {} a pixel or more (min_gradient), where {} % are wanted "
                    "(min_texture). Poses stay as {}. Check exposure and focus of the photographs; bare walls "
                    "show no more",
                    textured.seen, textured.textured, params.min_gradient, 100.0 * params.min_texture,
                    params.lambda_d > 0.0 ? "the depth has them" : "they are: lambda_d 0 leaves the depth out"));
}

// The optimised state or, where that is worse, the input; what its frames see.
struct Choice {
    AlignmentState state;
    Observations seen;
    std::optional<HeldOutScores> scores;
    bool is_input = false;
};

// Worse: by the energy, or by the texels that the solver did not see.
Choice better_of(const AlignmentProblem& reference, AlignmentState input, AlignmentState optimized)
{
    if (fit(reference, optimized).energy.total() > fit(reference, input).energy.total()) {
        log_warning("the alignment did not lower the energy; poses and planes stay as they were");
        return {std::move(input), reference.observations, {}, true};
    }
    Observations seen = observe(reference.scene, optimized, reference.texels, reference.level);
    const auto scores = judge(reference.scene, reference.texels, {input, reference.observations}, {optimized, seen});
    if (!scores) return {std::move(optimized), std::move(seen), {}};
    log_info(fmt::format("views of held-out texels differ by {:.2f} -> {:.2f} grey levels", scores->input,
                         scores->optimized));
    if (!scores->is_input_kept) return {std::move(optimized), std::move(seen), scores};
    log_warning(fmt::format(
        "poses, planes and colour camera stay as they were: after the optimisation the views of texels that it did not "
        "see differ by {:.2f} grey levels, before by {:.2f}. Check that photographs and depths belong together (times, "
        "calibration, place), and the weights lambda_p, lambda_t and lambda_d",
        scores->optimized, scores->input));
    return {std::move(input), reference.observations, scores, true};
}

void report(const AlignmentState& input, const AlignmentState& state, const std::vector<std::vector<double>>& rows)
{
    log_info(fmt::format("mean colour cost {:.4f} -> {:.4f}, mean depth cost {:.4f} -> {:.4f}", rows.front()[1],
                         rows.back()[1], rows.front()[4], rows.back()[4]));
    const Camera &was = input.color.camera, &is = state.color.camera;
    if (was.fx == is.fx) return;
    const Vector3 t = state.color.color_from_depth.inverse().translation() * 1000.0;
    log_info(fmt::format("colour camera f {:.1f} -> {:.1f}, cx {:.1f} -> {:.1f}, cy {:.1f} -> {:.1f} px; "
                         "depth_from_color ({:.1f}, {:.1f}, {:.1f}) mm, {:.2f} deg",
                         was.fx, is.fx, was.cx, is.cx, was.cy, is.cy, t.x(), t.y(), t.z(),
                         rotation_angle(state.color.color_from_depth.linear()) * 180.0 / std::numbers::pi));
}

Alignment to_alignment(const AlignmentState& state, std::vector<std::vector<double>> energy)
{
    Alignment alignment;
    alignment.camera_from_world = state.camera_from_world;
    for (const CenteredPlane& plane : state.plane)
        alignment.plane.push_back(plane.plane());
    alignment.gain.assign(state.camera_from_world.size(), Eigen::Vector3f::Ones());
    alignment.bias.assign(state.camera_from_world.size(), Eigen::Vector3f::Zero());
    alignment.color = state.color.camera;
    alignment.depth_from_color = state.color.color_from_depth.inverse();
    alignment.energy_name = kEnergyNames;
    alignment.energy = std::move(energy);
    return alignment;
}

// Bit by bit, which a state is not.
void set_input_geometry(Alignment& alignment, const AlignmentInput& input)
{
    for (std::size_t k = 0; k < input.keyframes.frame.size(); ++k)
        alignment.camera_from_world[k] = input.scan.frames[input.keyframes.frame[k]].camera_from_world;
    alignment.plane = input.mesh.plane;
    alignment.color = input.scan.color;
    alignment.depth_from_color = input.scan.depth_from_color;
}

} // namespace

Alignment optimize_texture(const AlignmentInput& input, const OptimizeTextureParams& requested)
{
    check(requested);
    const OptimizeTextureParams params = with_usable_levels(requested, input.scan.color);
    AlignmentScene scene = load_scene(input.scan, input.read, input.keyframes, input.mesh, params);
    const AlignmentState start = input_state(input.scan, input.keyframes, input.mesh);
    ProblemSource source = problem_source(scene, input.keyframes, input.lines, start);
    AlignmentProblem reference =
        make_problem(source, start, 0, kReferenceStride * level_spacing(params, 0), TexelChoice::All);
    if (params.optimize_exposure && params.optimize_vignetting) take_out_vignetting(scene, reference, start);
    source.lambda_p = reference.lambda_p = balanced_weight(reference, start);
    warn_of_blind_frames(reference);
    warn_of_missing_texture(reference, start);

    std::vector<std::vector<double>> rows{mean_energies(reference, start)};
    const auto record = [&](const AlignmentState& state) { rows.push_back(mean_energies(reference, state)); };
    const auto minimize = params.solver == AlignmentSolver::Joint ? minimize_by_pyramid : minimize_by_schedule;
    AlignmentState state = in_frame_of_mesh(reference, start, minimize(source, start, record));
    AlignmentProblem judged = reference;
    judged.weight = weights_at(reference, state);
    state = without_strays(judged, start, without_stray_normals(judged, start, std::move(state)));
    record(state);
    const Choice best = better_of(judged, start, std::move(state));
    if (best.is_input) record(best.state);
    report(start, best.state, rows);
    Alignment alignment = to_alignment(best.state, std::move(rows));
    alignment.held_out = best.scores;
    if (best.is_input) set_input_geometry(alignment, input);
    if (params.optimize_exposure)
        set_channel_exposures(alignment, {scene, input.keyframes, input.read, reference.texels, best.seen}, best.state);
    return alignment;
}

Alignment optimize_texture(const ScanImages& images, const Keyframes& keyframes, const PlaneMesh& mesh,
                           const LineMatches& lines, const OptimizeTextureParams& params)
{
    const ImageReader read{[&](FrameId id) { return images.color(id); }, [&](FrameId id) { return images.depth(id); }};
    return optimize_texture({images.scan(), read, keyframes, mesh, lines}, params);
}

} // namespace quoin
