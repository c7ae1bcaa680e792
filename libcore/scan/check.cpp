#include "scan/check.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace quoin {
namespace {

constexpr int kStride = 8;            // a pixel in so many along both axes is compared
constexpr double kLeastOverlap = 0.1; // share of the compared pixels that both frames of the pairs see

// Depth units of the sensors and data sets in use [m].
constexpr std::array kCommonUnits{1.0 / 1000.0, 1.0 / 5000.0, 1.0 / 4000.0, 1.0 / 10000.0, 1.0 / 256.0};

std::vector<FrameId> frames_to_compare(const Scan& scan)
{
    std::vector<FrameId> ids = scan.frames_in_use();
    std::erase_if(ids, [&](FrameId id) { return !scan.frames[id].has_depth(); });
    return ids;
}

struct Differences {
    std::vector<double> absolute; // [m]
    std::vector<double> relative;
};

// Points of one depth image (in steps of `unit` metres) against the depth of another one.
Differences differences(const Camera& camera, const Image<float>& from, const Image<float>& to,
                        const Rigid& to_from_from, double unit)
{
    Differences result;
    for (int y = 0; y < from.height; y += kStride)
        for (int x = 0; x < from.width; x += kStride) {
            const Eigen::Vector3d p_to = to_from_from * (unit * from.at(x, y) * camera.ray({x, y}));
            if (from.at(x, y) <= 0.0f || p_to.z() <= 0.0) continue;
            const Eigen::Vector2d pixel = camera.project(p_to);
            if (!camera.contains(pixel)) continue;
            const double z = unit * to.at(static_cast<int>(pixel.x() + 0.5), static_cast<int>(pixel.y() + 0.5));
            if (z <= 0.0) continue;
            result.absolute.push_back(std::abs(z - p_to.z()));
            result.relative.push_back(std::abs(z - p_to.z()) / p_to.z());
        }
    return result;
}

double median(std::vector<double>& values)
{
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

// Frames that `seconds` span, by the median time between two; from 1 to half of them.
std::size_t frames_between(const Scan& scan, const std::vector<FrameId>& ids, double seconds)
{
    std::vector<double> steps;
    for (std::size_t i = 1; i < ids.size(); ++i)
        steps.push_back(scan.frames[ids[i]].time - scan.frames[ids[i - 1]].time);
    const double step = median(steps);
    const double wanted = step > 0.0 ? std::round(seconds / step) : 1.0;
    const std::size_t half = ids.size() / 2;
    return static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(half)));
}

int changes(const PoseConvention& a, const PoseConvention& b)
{
    return (a.world_to_camera != b.world_to_camera) + (a.y_up_z_back != b.y_up_z_back) + (a.flip_y != b.flip_y);
}

// All readings, those that differ least from the current one first.
std::vector<Reading> readings_around(const Reading& current)
{
    std::vector<Reading> readings;
    for (const bool inverse : {false, true})
        for (const bool axes : {false, true})
            for (const bool flip : {false, true}) {
                const PoseConvention convention{inverse, axes, flip};
                readings.push_back({convention, current.depth_unit});
                for (const double unit : kCommonUnits)
                    if (std::abs(unit - current.depth_unit) > 1e-9) readings.push_back({convention, unit});
            }
    std::ranges::stable_sort(readings, {}, [&](const Reading& reading) {
        return changes(reading.convention, current.convention) + (reading.depth_unit != current.depth_unit);
    });
    return readings;
}

} // namespace

ReprojectionCheck::ReprojectionCheck(const ScanImages& images, std::vector<Eigen::Matrix4d> listed_poses,
                                     const CheckSettings& settings)
    : camera_(images.scan().depth), good_(settings.good)
{
    const std::vector<FrameId> ids = frames_to_compare(images.scan());
    if (ids.size() < 2 || settings.pairs == 0) return;
    const std::size_t gap = gap_ = frames_between(images.scan(), ids, settings.gap);
    const std::size_t possible = ids.size() - gap;
    const std::size_t count = std::min(static_cast<std::size_t>(settings.pairs), possible);
    std::map<FrameId, std::size_t> view_of; // a frame can be in two pairs
    const auto view = [&](FrameId id) { return view_of.emplace(id, view_of.size()).first->second; };
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = i * possible / count;
        const std::size_t from = view(ids[first]);
        pairs_.push_back({from, view(ids[first + gap])});
    }
    views_.resize(view_of.size());
    const std::vector<std::pair<FrameId, std::size_t>> reads(view_of.begin(), view_of.end());
    const float steps_a_metre = static_cast<float>(1.0 / images.scan().depth_unit);
    parallel_for(reads.size(), [&](std::size_t i) {
        View& target = views_[reads[i].second];
        target = {listed_poses[reads[i].first], images.depth(reads[i].first)};
        for (float& value : target.steps.pixels)
            value *= steps_a_metre;
    });
}

bool ReprojectionCheck::overlaps(const ScanCheck& check) const
{
    const double pixels = std::ceil(1.0 * camera_.width / kStride) * std::ceil(1.0 * camera_.height / kStride);
    return static_cast<double>(check.samples) >= kLeastOverlap * pixels * static_cast<double>(check.pairs);
}

ScanCheck ReprojectionCheck::agreement(const Reading& reading) const
{
    const double unit = reading.depth_unit;
    const auto compare = [&](std::size_t begin, std::size_t) {
        const View& from = views_[pairs_[begin].from];
        const View& to = views_[pairs_[begin].to];
        const Rigid to_from_world = camera_from_world(to.listed, reading.convention);
        const Rigid from_from_world = camera_from_world(from.listed, reading.convention);
        return differences(camera_, from.steps, to.steps, to_from_world * from_from_world.inverse(), unit);
    };
    Differences all = parallel_reduce(pairs_.size(), 1, Differences{}, compare, [](Differences a, Differences b) {
        a.absolute.insert(a.absolute.end(), b.absolute.begin(), b.absolute.end());
        a.relative.insert(a.relative.end(), b.relative.begin(), b.relative.end());
        return a;
    });
    const std::size_t samples = all.absolute.size();
    return {pairs_.size(), samples, median(all.absolute), median(all.relative)};
}

Reading ReprojectionCheck::better_reading(const Reading& current, double ratio) const
{
    constexpr double as_good = 1.25; // readings within this factor of the best are equals
    const ScanCheck now = agreement(current);
    std::vector<std::pair<double, Reading>> candidates;
    for (const Reading& reading : readings_around(current)) {
        const ScanCheck check = agreement(reading);
        const bool fits = check.samples * 2 >= now.samples && overlaps(check) && is_good(check) &&
                          (now.samples == 0 || check.relative * ratio <= now.relative);
        if (fits) candidates.emplace_back(check.relative, reading);
    }
    if (candidates.empty()) return current;
    const double best = std::ranges::min_element(candidates, {}, &std::pair<double, Reading>::first)->first;
    return std::ranges::find_if(candidates, [&](const auto& candidate) { return candidate.first <= as_good * best; })
        ->second;
}

} // namespace quoin
