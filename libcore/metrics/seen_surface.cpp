#include "metrics/seen_surface.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/units.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Keyframes whose results are in memory at a time.
constexpr std::size_t kBatch = 32;

class KeyframeSight {
public:
    KeyframeSight(const Evaluated& inputs, std::size_t k, const EvaluateParams& params)
        : params_(params), color_(inputs.alignment->color), depth_(inputs.scan->depth),
          color_from_world_(inputs.alignment->color_from_world(k)),
          depth_from_world_(inputs.alignment->camera_from_world[k]),
          drawn_(rasterize(inputs.model()->mesh, color_, color_from_world_).depth),
          measured_(inputs.images->depth(inputs.keyframes->frame[k])),
          least_facing_(std::cos(params.seen_angle / kDegrees))
    {
    }

    bool sees(const SurfaceSample& sample) const
    {
        const Vector3d p = color_from_world_ * sample.position;
        if (p.z() < params_.seen_min_depth || p.z() > params_.seen_max_depth) return false;
        const Vector2d pixel = color_.project(p);
        if (!color_.contains(pixel)) return false;
        const double facing = -(color_from_world_.linear() * sample.normal).dot(p) / p.norm();
        if (facing < least_facing_) return false;
        // An oblique surface changes its depth within a pixel.
        const double drawn = value_at(drawn_, pixel);
        if (drawn > 0.0 && drawn < p.z() - tolerance(p.z()) - p.z() / (color_.fx * facing)) return false;
        return agrees_with_measured(depth_from_world_ * sample.position, facing);
    }

private:
    double tolerance(double z) const { return params_.depth_tolerance * std::max(1.0, z); }

    static double value_at(const DepthImage& image, const Vector2d& pixel)
    {
        return image.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    }

    bool agrees_with_measured(const Vector3d& p, double facing) const
    {
        if (measured_.empty() || p.z() <= 0.0) return true;
        const Vector2d pixel = depth_.project(p);
        if (!depth_.contains(pixel)) return true;
        const double measured = value_at(measured_, pixel);
        return measured == 0.0 || std::abs(measured - p.z()) <= tolerance(p.z()) + p.z() / (depth_.fx * facing);
    }

    const EvaluateParams& params_;
    Camera color_, depth_;
    Rigid color_from_world_, depth_from_world_;
    DepthImage drawn_, measured_; // of the model in the colour camera; of the sensor
    double least_facing_;
};

} // namespace

std::vector<std::uint8_t> seen_by_keyframes(std::span<const SurfaceSample> samples, const Evaluated& inputs,
                                            const EvaluateParams& params)
{
    const std::size_t count = inputs.keyframes->frame.size();
    if (inputs.alignment->camera_from_world.size() != count)
        throw InputError(fmt::format("alignment of {} keyframes, keyframes of {}: they come from different runs",
                                     inputs.alignment->camera_from_world.size(), count));
    std::vector<std::uint8_t> seen(samples.size(), 0);
    Progress progress("looking from keyframes", count);
    for (std::size_t first = 0; first < count; first += kBatch) {
        std::vector<std::vector<std::uint8_t>> by_keyframe(std::min(kBatch, count - first));
        parallel_for(by_keyframe.size(), [&](std::size_t i) {
            const KeyframeSight sight(inputs, first + i, params);
            by_keyframe[i].resize(samples.size());
            std::ranges::transform(samples, by_keyframe[i].begin(),
                                   [&](const SurfaceSample& s) { return sight.sees(s) ? 1 : 0; });
            progress.step();
        });
        for (const auto& sees : by_keyframe)
            for (std::size_t s = 0; s < seen.size(); ++s)
                seen[s] |= sees[s];
    }
    return seen;
}

} // namespace quoin
