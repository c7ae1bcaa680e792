// What of the light model one keyframe could photograph.
#pragma once

#include "metrics/evaluate.h"
#include "metrics/surface.h"

#include <optional>

namespace quoin {

struct Look {
    Eigen::Vector2d pixel;   // in the colour image
    double resolution = 0.0; // pixels per metre on the surface, the geometric mean over its directions
};

// From its aligned pose. Requires scan, images, keyframes and alignment that belong together, and a light model; all of
// it outlives the sight.
class KeyframeSight {
public:
    KeyframeSight(const Evaluated& inputs, std::size_t k, const EvaluateParams& params);
    // nullopt when the keyframe does not see the point: one that lies in its colour image, between seen_min_depth and
    // seen_max_depth, on a face that turns its front to the camera by no more than seen_angle, with nothing of the
    // model nearer and nothing of the measured depth elsewhere: by depth_tolerance, as in held-out views. Unlike the
    // baking, this asks for no distance from edges of depth or of the image, and for no measured depth.
    std::optional<Look> look(const SurfaceSample& sample) const;

private:
    double tolerance(double z) const; // [m]
    bool agrees_with_measured(const Eigen::Vector3d& p_depth, double facing) const;

    const EvaluateParams& params_;
    Camera color_, depth_;
    Rigid color_from_world_, depth_from_world_;
    DepthImage drawn_, measured_; // of the model in the colour camera; of the sensor
    double least_facing_;
};

} // namespace quoin
