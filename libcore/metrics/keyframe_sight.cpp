#include "metrics/keyframe_sight.h"

#include "geometry/units.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double value_at(const DepthImage& image, const Vector2d& pixel)
{
    return image.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
}

} // namespace

KeyframeSight::KeyframeSight(const Evaluated& inputs, std::size_t k, const EvaluateParams& params)
    : params_(params), color_(inputs.alignment->color), depth_(inputs.scan->depth),
      color_from_world_(inputs.alignment->color_from_world(k)),
      depth_from_world_(inputs.alignment->camera_from_world[k]),
      drawn_(rasterize(inputs.model()->mesh, color_, color_from_world_).depth),
      measured_(inputs.images->depth(inputs.keyframes->frame[k])), least_facing_(std::cos(params.seen_angle / kDegrees))
{
}

std::optional<Look> KeyframeSight::look(const SurfaceSample& sample) const
{
    const Vector3d p = color_from_world_ * sample.position;
    if (p.z() < params_.seen_min_depth || p.z() > params_.seen_max_depth) return std::nullopt;
    const Vector2d pixel = color_.project(p);
    if (!color_.contains(pixel)) return std::nullopt;
    const double facing = -(color_from_world_.linear() * sample.normal).dot(p) / p.norm();
    if (facing < least_facing_) return std::nullopt;
    // An oblique surface changes its depth within a pixel.
    const double drawn = value_at(drawn_, pixel);
    if (drawn > 0.0 && drawn < p.z() - tolerance(p.z()) - p.z() / (color_.fx * facing)) return std::nullopt;
    if (!agrees_with_measured(depth_from_world_ * sample.position, facing)) return std::nullopt;
    return Look{pixel, color_.fx * std::sqrt(facing) / p.z()};
}

double KeyframeSight::tolerance(double z) const { return params_.depth_tolerance * std::max(1.0, z); }

bool KeyframeSight::agrees_with_measured(const Vector3d& p_depth, double facing) const
{
    if (measured_.empty() || p_depth.z() <= 0.0) return true;
    const Vector2d pixel = depth_.project(p_depth);
    if (!depth_.contains(pixel)) return true;
    const double measured = value_at(measured_, pixel);
    return measured == 0.0 ||
           std::abs(measured - p_depth.z()) <= tolerance(p_depth.z()) + p_depth.z() / (depth_.fx * facing);
}

} // namespace quoin
