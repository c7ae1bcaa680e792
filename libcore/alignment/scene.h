// What stays as it is while poses and planes move: mesh, images, calibration of the depth camera, parameters.
#pragma once

#include "alignment/params.h"
#include "alignment/state.h"
#include "image/image.h"
#include "mesh/plane_mesh.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <functional>
#include <vector>

namespace quoin {

// Where images come from: the files of a scan, or memory. Called from several threads.
struct ImageReader {
    std::function<ColorImage(FrameId)> color;
    std::function<DepthImage(FrameId)> depth; // empty image: the frame has none
};

struct KeyframeImages {
    std::vector<GrayImage> gray;   // one per level, smoothed; level l is 1/2^l of the size
    DepthImage depth;              // [m]; empty if the frame has none
    Image<std::uint8_t> near_edge; // 1 near a jump of the depth; size of `depth`
};

struct AlignmentScene {
    const PlaneMesh& mesh;
    const OptimizeTextureParams& params;
    Camera depth_camera;
    std::vector<KeyframeImages> images; // K

    std::size_t frames() const { return images.size(); }
    // Standard deviation of a measured depth [m].
    double depth_sigma(double z) const { return params.depth_noise_floor + params.depth_noise * z * z; }
};

AlignmentScene load_scene(const Scan& scan, const ImageReader& read, const Keyframes& keyframes, const PlaneMesh& mesh,
                          const OptimizeTextureParams& params);

// The least step between neighbouring depths that is an edge, by the nearer one: max(least, floor + square z^2) [m].
struct DepthJump {
    double least = 0.0, floor = 0.0, square = 0.0;
};

// Marks pixels within `radius` of an edge. Missing depth is no edge.
Image<std::uint8_t> near_depth_edges(const DepthImage& depth, int radius, const DepthJump& jump);

} // namespace quoin
