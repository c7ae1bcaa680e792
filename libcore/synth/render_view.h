#pragma once

#include "geometry/camera.h"
#include "synth/painted_room.h"

#include <span>

namespace quoin {

struct View {
    Camera camera;
    Rigid world_from_camera;
};

using ColorField = Image<Eigen::Vector3f>; // 0..255, not rounded

// What an ideal camera sees. Surfaces are filtered over the footprint of a pixel; pixels on an edge are cast 16 times.
ColorField render_color(const PaintedRoom& room, const View& view);
// The mean over the poses of a moving camera.
ColorField render_moving(const PaintedRoom& room, std::span<const View> views);

struct ExactDepth {
    DepthImage depth; // z [m]
    GrayImage cosine; // between the ray and the surface's normal; <= 0 from behind
};
ExactDepth render_depth(const PaintedRoom& room, const View& view);

} // namespace quoin
