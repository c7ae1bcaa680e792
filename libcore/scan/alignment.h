#pragma once

#include "geometry/camera.h"
#include "geometry/plane.h"
#include "geometry/rigid.h"
#include "scan/vignetting.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

// How far the views of texels that the solver did not see are from one colour: robust RMS [grey levels of 255], each
// with the exposures that fit it best.
struct HeldOutScores {
    double input = 0.0, optimized = 0.0;
    bool is_input_kept = false; // the alignment is the input, which is better
};

// What optimize-texture finds: poses of the keyframes, planes, exposures and, when asked for, the calibration.
struct Alignment {
    std::vector<Rigid> camera_from_world; // K, depth camera of each keyframe, in the order of Keyframes::frame
    std::vector<Plane> plane;             // P, in the order of PlaneMesh::plane
    // Colour in the common exposure = gain * (vignetting's correction * observed) + bias (0..255).
    std::vector<Eigen::Vector3f> gain; // K
    std::vector<Eigen::Vector3f> bias; // K
    Vignetting vignetting;
    Camera color; // colour camera, refined or the scan's
    Rigid depth_from_color = Rigid::Identity();
    std::vector<std::string> energy_name;    // columns of `energy`: "color", "plane", "line", ...
    std::vector<std::vector<double>> energy; // one row per round: mean robust cost of each term
    std::optional<HeldOutScores> held_out;   // where the result could be judged

    Rigid color_from_world(std::size_t keyframe) const
    {
        return depth_from_color.inverse() * camera_from_world[keyframe];
    }
};

} // namespace quoin
