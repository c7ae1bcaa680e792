// A small textured room (textured_room.h), aligned.
#pragma once

#include "alignment/optimize_texture.h"
#include "textured_room.h"

namespace quoin::testing {

inline OptimizeTextureParams small_room_params()
{
    OptimizeTextureParams params;
    params.texel_size = 0.01; // the images are small
    params.texel_stride = 3;
    params.visibility_rounds = 1;
    params.jump_radius = 1;
    params.prior_translation = 0.05;
    params.shared_errors = 1e9; // the errors of these pixels and depths are independent
    params.shared_area = 1e9;   // as are those of the mesh
    params.calibration = CalibrationUse::Fixed;
    return params;
}

inline Alignment align(const TexturedRoom& room, const OptimizeTextureParams& params, const LineMatches& lines = {})
{
    return optimize_texture({room.scan, room.reader(), room.keyframes, room.mesh, lines}, params);
}

inline std::vector<Rigid> input_poses(const TexturedRoom& room)
{
    std::vector<Rigid> poses;
    for (const Frame& frame : room.scan.frames)
        poses.push_back(frame.camera_from_world);
    return poses;
}

inline double relative_position_error(const TexturedRoom& room, const Alignment& alignment)
{
    return position_error(alignment.camera_from_world, room.true_camera_from_world) /
           position_error(input_poses(room), room.true_camera_from_world);
}

} // namespace quoin::testing
