// How a data set writes poses, and how they become ours (camera from world; +x right, +y down, +z forward).
#pragma once

#include "geometry/rigid.h"

#include <string>

namespace quoin {

struct PoseConvention {
    bool world_to_camera = false; // the files map world to camera; otherwise camera to world
    bool y_up_z_back = false;     // camera axes of OpenGL and ARKit; otherwise y down, z forward
    // The camera was published with fy < 0: its y axis runs against the image's. Conjugating every pose with
    // F = diag(1, -1, 1) makes fy positive and keeps the transforms rotations; the world is mirrored along.
    bool flip_y = false;

    bool operator==(const PoseConvention&) const = default;
};

// The pose of a file in our convention. Requires a rigid matrix (is_rigid).
Rigid camera_from_world(const Eigen::Matrix4d& listed, const PoseConvention& convention);

} // namespace quoin
