#include "alignment/scene.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "image/sampling.h"

namespace quoin {
namespace {

constexpr float kNearJump = -1.0f; // stands for depths near a jump [m]

// Every level is halved from the raw one above it, and smoothed only to be sampled.
std::vector<CornerImage> pyramid(GrayImage gray, const OptimizeTextureParams& params)
{
    std::vector<CornerImage> levels;
    for (int level = 0; level < params.levels; ++level) {
        if (level > 0) gray = half_size(gray);
        levels.push_back(params.smoothing > 0.0 ? smooth(gray, params.smoothing) : gray);
    }
    return levels;
}

} // namespace

AlignmentScene load_scene(const Scan& scan, const ImageReader& read, const Keyframes& keyframes, const PlaneMesh& mesh,
                          const OptimizeTextureParams& params)
{
    AlignmentScene scene{mesh, params, scan.depth, {}};
    scene.images.resize(keyframes.frame.size());
    Progress progress("reading keyframes", scene.images.size());
    parallel_for(scene.images.size(), [&](std::size_t k) {
        KeyframeImages& images = scene.images[k];
        images.gray = pyramid(to_gray(read.color(keyframes.frame[k])), params);
        images.depth = read.depth(keyframes.frame[k]);
        const DepthJump jump{params.depth_jump, 3.0 * params.depth_noise_floor, 3.0 * params.depth_noise};
        for_each(near_depth_edges(images.depth, params.jump_radius, jump),
                 [&](int x, int y) { images.depth.at(x, y) = kNearJump; });
        progress.step();
    });
    return scene;
}

} // namespace quoin
