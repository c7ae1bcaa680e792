#include "base/error.h"
#include "metrics/trajectory.h"
#include "metrics/truth_metrics.h"

#include <fmt/format.h>

namespace quoin {
namespace {

void check_belongs(const Evaluated& inputs)
{
    const GroundTruth& truth = *inputs.truth;
    if (truth.world_from_camera.size() != inputs.scan->frames.size())
        throw InputError(fmt::format("ground truth of {} frames, scan of {}: they do not belong together; give the "
                                     "folder that the scan was imported from",
                                     truth.world_from_camera.size(), inputs.scan->frames.size()));
}

void add_trajectory(MetricList& list, const std::string& name, const TrajectoryError& error)
{
    list.lower(name + ".ate", "mm", error.ate * kMillimetres);
    list.lower(name + ".ate_median", "mm", error.ate_median * kMillimetres);
    list.lower(name + ".rpe_position", "mm", error.relative_position * kMillimetres);
    list.lower(name + ".rpe_rotation", "deg", error.relative_rotation * kDegrees);
}

} // namespace

void add_pose_metrics(MetricList& list, const Evaluated& inputs)
{
    if (!inputs.scan) return;
    check_belongs(inputs);
    const std::vector<FrameId> frames = inputs.keyframes ? inputs.keyframes->frame : inputs.scan->frames_in_use();
    if (frames.empty()) return;
    std::vector<Rigid> recorded, truth, aligned;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        recorded.push_back(inputs.scan->frames.at(frames[k]).camera_from_world.inverse());
        truth.push_back(inputs.truth->world_from_camera[frames[k]]);
        if (inputs.keyframes && inputs.alignment) aligned.push_back(inputs.alignment->camera_from_world[k].inverse());
    }
    const TrajectoryError before = compare_trajectories(recorded, truth);
    add_trajectory(list, "poses.input", before);
    if (aligned.empty()) return;
    const TrajectoryError after = compare_trajectories(aligned, truth);
    add_trajectory(list, "poses", after);
    if (before.ate > 0.0) list.higher("poses.ate_reduction", "", 1.0 - after.ate / before.ate);
}

void add_exposure_metrics(MetricList& list, const Evaluated& inputs)
{
    if (!inputs.scan || !inputs.keyframes || !inputs.alignment) return;
    check_belongs(inputs);
    if (inputs.truth->exposure.size() != inputs.scan->frames.size() ||
        inputs.alignment->gain.size() != inputs.keyframes->frame.size())
        return;
    // common = gain * observed and observed = true_gain * true leave gain * true_gain constant over frames; the mean of
    // its logarithm is the factor that nobody can know.
    const std::size_t count = inputs.keyframes->frame.size();
    double before = 0.0, after = 0.0;
    for (int c = 0; c < 3; ++c) {
        double mean_before = 0.0, mean_after = 0.0;
        const auto true_log = [&](std::size_t k) {
            return std::log(inputs.truth->exposure[inputs.keyframes->frame[k]].gain[c]);
        };
        const auto both_log = [&](std::size_t k) {
            return true_log(k) + std::log(static_cast<double>(inputs.alignment->gain[k][c]));
        };
        for (std::size_t k = 0; k < count; ++k)
            mean_before += true_log(k) / static_cast<double>(count),
                mean_after += both_log(k) / static_cast<double>(count);
        for (std::size_t k = 0; k < count; ++k) {
            before += std::abs(std::expm1(true_log(k) - mean_before)) / static_cast<double>(3 * count);
            after += std::abs(std::expm1(both_log(k) - mean_after)) / static_cast<double>(3 * count);
        }
    }
    list.plain("exposure.input.gain_error", "%", 100.0 * before);
    list.lower("exposure.gain_error", "%", 100.0 * after);
}

} // namespace quoin
