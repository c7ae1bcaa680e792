#pragma once

#include "geometry/camera.h"
#include "geometry/rigid.h"
#include "synth/synthesize.h"

#include <vector>

namespace quoin {

// Both cameras of the sensor: the image centre is the optical axis.
Camera sensor_camera(const SynthParams& params);

// True poses of the depth camera, world_from_camera: who holds it walks around the middle of the room and turns four
// times, looking up at first and down later, so that walls, ceiling, floor and furniture come into view. Smooth, with
// the hand's tremble.
std::vector<Rigid> hand_held_path(const SynthParams& params);

// A smooth random walk of `frames` steps in `dimensions` (rows), whose largest norm is 1; zero for one frame.
Eigen::MatrixXd smooth_walk(const SynthParams& params, std::uint64_t stream, int dimensions);

} // namespace quoin
