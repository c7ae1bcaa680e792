// What stays as it is while poses and planes move: mesh, images, calibration of the depth camera, parameters.
#pragma once

#include "alignment/corner_image.h"
#include "alignment/depth_edges.h"
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
    std::vector<CornerImage> gray; // one per level, smoothed; level l is 1/2^l of the size
    DepthImage depth;              // [m]; negative near a jump; empty if the frame has none
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

} // namespace quoin
