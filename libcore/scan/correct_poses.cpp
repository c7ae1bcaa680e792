#include "scan/correct_poses.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

// How a camera was moved and turned: rotation vector [rad] and shift of its centre [m], both along the world's axes.
using Correction = Twist;

Correction correction_of(const Rigid& before_from_world, const Rigid& after_from_world)
{
    const Rigid before = before_from_world.inverse(), after = after_from_world.inverse();
    Rigid turn = Rigid::Identity();
    turn.linear() = after.linear() * before.linear().transpose();
    Correction correction;
    correction.head<3>() = log_twist(turn).head<3>();
    correction.tail<3>() = after.translation() - before.translation();
    return correction;
}

Rigid corrected(const Rigid& camera_from_world, const Correction& correction)
{
    Twist turn = Twist::Zero();
    turn.head<3>() = correction.head<3>();
    Rigid pose = camera_from_world.inverse();
    pose.linear() = exp_twist(turn).linear() * pose.linear();
    pose.translation() += correction.tail<3>();
    return orthonormalized(pose.inverse());
}

void check(const Scan& scan, const Keyframes& keyframes, const Alignment& alignment)
{
    if (alignment.camera_from_world.size() != keyframes.frame.size())
        throw InputError(
            fmt::format("the alignment has {} poses and there are {} keyframes; both must come from one run",
                        alignment.camera_from_world.size(), keyframes.frame.size()));
    if (!keyframes.frame.empty() && keyframes.frame.back() >= scan.frames.size())
        throw InputError(fmt::format("the keyframes name frame {} and the scan has {}; both must come from one run",
                                     keyframes.frame.back(), scan.frames.size()));
}

// The corrections of the keyframes over the numbers of the frames.
class CorrectionCurve {
public:
    CorrectionCurve(const std::vector<FrameId>& frame, std::vector<Correction> correction)
        : frame_(frame), correction_(std::move(correction))
    {
    }

    Correction at(FrameId id) const
    {
        const auto next = static_cast<std::size_t>(std::ranges::upper_bound(frame_, id) - frame_.begin());
        if (next == 0) return correction_.front();
        if (next == frame_.size()) return correction_.back();
        const std::size_t k = next - 1;
        const double length = gap(k, next), t = (id - frame_[k]) / length, t2 = t * t, t3 = t2 * t;
        return (2 * t3 - 3 * t2 + 1) * correction_[k] + (t3 - 2 * t2 + t) * length * slope(k) +
               (3 * t2 - 2 * t3) * correction_[next] + (t3 - t2) * length * slope(next);
    }

private:
    double gap(std::size_t a, std::size_t b) const { return static_cast<double>(frame_[b] - frame_[a]); }
    // Per frame, between the neighbours; none at the ends.
    Correction slope(std::size_t k) const
    {
        if (k == 0 || k + 1 == frame_.size()) return Correction::Zero();
        return (correction_[k + 1] - correction_[k - 1]) / gap(k - 1, k + 1);
    }

    const std::vector<FrameId>& frame_;
    std::vector<Correction> correction_;
};

} // namespace

Scan corrected_scan(Scan scan, const Keyframes& keyframes, const Alignment& alignment)
{
    check(scan, keyframes, alignment);
    scan.color = alignment.color;
    scan.depth_from_color = alignment.depth_from_color;
    if (keyframes.frame.empty()) return scan;
    std::vector<Correction> corrections;
    for (std::size_t k = 0; k < keyframes.frame.size(); ++k)
        corrections.push_back(
            correction_of(scan.frames[keyframes.frame[k]].camera_from_world, alignment.camera_from_world[k]));
    const CorrectionCurve curve(keyframes.frame, std::move(corrections));
    for (FrameId id = 0; id < scan.frames.size(); ++id)
        if (scan.frames[id].use != FrameUse::Invalid)
            scan.frames[id].camera_from_world = corrected(scan.frames[id].camera_from_world, curve.at(id));
    return scan;
}

} // namespace quoin
