#include "compare/schemas.h"
#include "geometry/units.h"
#include "metrics/surface.h"
#include "schema/schema.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace quoin {
namespace fs = std::filesystem;
namespace {

using Lines = std::vector<std::string>;

std::string poses_text(const std::vector<std::pair<Rigid, Rigid>>& pairs)
{
    if (pairs.empty()) return "no pose in common";
    std::vector<double> angles, distances;
    for (const auto& [a, b] : pairs) {
        const Rigid motion = a.inverse() * b; // of the camera in the world
        angles.push_back(rotation_angle(motion.rotation()) * kDegrees);
        distances.push_back((a.inverse().translation() - b.inverse().translation()).norm() * kMillimetres);
    }
    return fmt::format("poses: rotation median {:.4f}, largest {:.4f} deg; position median {:.3f}, largest {:.3f} mm",
                       median(angles), *std::ranges::max_element(angles), median(distances),
                       *std::ranges::max_element(distances));
}

double largest_difference(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b)
{
    float largest = 0.0f;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, (a[i] - b[i]).cwiseAbs().maxCoeff());
    return static_cast<double>(largest);
}

} // namespace

Lines compare_alignments(const fs::path& first, const fs::path& second)
{
    const Alignment a = read_alignment(first), b = read_alignment(second);
    Lines lines{fmt::format("keyframes {}, {}; planes {}, {}", a.camera_from_world.size(), b.camera_from_world.size(),
                            a.plane.size(), b.plane.size())};
    if (a.camera_from_world.size() == b.camera_from_world.size()) {
        std::vector<std::pair<Rigid, Rigid>> pairs;
        for (std::size_t i = 0; i < a.camera_from_world.size(); ++i)
            pairs.emplace_back(a.camera_from_world[i], b.camera_from_world[i]);
        lines.push_back(poses_text(pairs));
        lines.push_back(fmt::format("exposure: gain by up to {:.4f}, bias by up to {:.3f} of 255",
                                    largest_difference(a.gain, b.gain), largest_difference(a.bias, b.bias)));
    }
    if (a.plane.size() == b.plane.size() && !a.plane.empty()) {
        std::vector<double> angles, offsets;
        for (std::size_t i = 0; i < a.plane.size(); ++i) {
            const auto &n = a.plane[i].normal, &m = b.plane[i].normal;
            angles.push_back(std::atan2(n.cross(m).norm(), n.dot(m)) * kDegrees);
            offsets.push_back(std::abs(a.plane[i].offset - b.plane[i].offset) * kMillimetres);
        }
        lines.push_back(fmt::format(
            "planes: angle median {:.4f}, largest {:.4f} deg; offset median {:.3f}, largest {:.3f} mm", median(angles),
            *std::ranges::max_element(angles), median(offsets), *std::ranges::max_element(offsets)));
    }
    return lines;
}

Lines compare_scans(const fs::path& first, const fs::path& second)
{
    const Scan a = read_scan(first), b = read_scan(second);
    std::map<std::string, const Frame*> by_name; // frames are the same when their images are called the same
    for (const auto& frame : b.frames)
        by_name.emplace(frame.name(), &frame);
    std::vector<std::pair<Rigid, Rigid>> pairs;
    std::size_t common = 0, contents = 0, uses = 0;
    for (const auto& frame : a.frames) {
        const auto other = by_name.find(frame.name());
        if (other == by_name.end()) continue;
        ++common;
        const Frame& twin = *other->second;
        if (frame.color.sha256 != twin.color.sha256 || frame.depth.sha256 != twin.depth.sha256) ++contents;
        if (frame.use != twin.use) ++uses;
        if (frame.use != FrameUse::Invalid && twin.use != FrameUse::Invalid)
            pairs.emplace_back(frame.camera_from_world, twin.camera_from_world);
    }
    return {fmt::format("frames {}, {}: {} in common, {} of them with other images, {} used otherwise", a.frames.size(),
                        b.frames.size(), common, contents, uses),
            poses_text(pairs)};
}

Lines compare_keyframes(const fs::path& first, const fs::path& second)
{
    const Keyframes a = read_keyframes(first), b = read_keyframes(second);
    std::vector<FrameId> only_first, only_second;
    std::ranges::set_difference(a.frame, b.frame, std::back_inserter(only_first));
    std::ranges::set_difference(b.frame, a.frame, std::back_inserter(only_second));
    return {fmt::format("keyframes {}, {}", a.frame.size(), b.frame.size()),
            fmt::format("only in the first: {}", fmt::join(only_first, " ")),
            fmt::format("only in the second: {}", fmt::join(only_second, " "))};
}

Lines compare_metrics(const fs::path& first, const fs::path& second)
{
    std::map<std::string, Metric> others;
    for (auto& metric : read_metrics(second))
        others.emplace(metric.name, metric);
    Lines lines;
    for (const auto& metric : read_metrics(first)) {
        const auto other = others.extract(metric.name);
        if (other.empty()) {
            lines.push_back(fmt::format("{:<40} {:>12.6g} {:>12} {}", metric.name, metric.value, "-", metric.unit));
            continue;
        }
        const double value = other.mapped().value;
        const bool is_same = value == metric.value || (std::isnan(value) && std::isnan(metric.value));
        if (is_same) continue;
        const bool is_better = metric.better == Better::Lower ? value < metric.value : value > metric.value;
        lines.push_back(fmt::format("{:<40} {:>12.6g} {:>12.6g} {} {}", metric.name, metric.value, value, metric.unit,
                                    metric.better == Better::Neither ? ""
                                    : is_better                      ? "(better)"
                                                                     : "(worse)"));
    }
    for (const auto& [name, metric] : others)
        lines.push_back(fmt::format("{:<40} {:>12} {:>12.6g} {}", name, "-", metric.value, metric.unit));
    return lines;
}

} // namespace quoin
