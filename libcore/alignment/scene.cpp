#include "alignment/scene.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "image/sampling.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

// Every level is halved from the raw one above it, and smoothed only to be sampled.
std::vector<GrayImage> pyramid(GrayImage gray, const OptimizeTextureParams& params)
{
    std::vector<GrayImage> levels;
    for (int level = 0; level < params.levels; ++level) {
        if (level > 0) gray = half_size(gray);
        levels.push_back(params.smoothing > 0.0 ? smooth(gray, params.smoothing) : gray);
    }
    return levels;
}

// Sets 1 within `radius` of every 1, in a square window: rows, then columns.
void dilate(Image<std::uint8_t>& mask, int radius)
{
    Image<std::uint8_t> rows = mask;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (mask.at(x, y))
                std::fill(&rows.at(std::max(0, x - radius), y), &rows.at(std::min(mask.width - 1, x + radius), y) + 1,
                          1);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (rows.at(x, y))
                for (int v = std::max(0, y - radius); v <= std::min(mask.height - 1, y + radius); ++v)
                    mask.at(x, v) = 1;
}

} // namespace

Image<std::uint8_t> near_depth_edges(const DepthImage& depth, int radius, const std::function<double(double)>& jump)
{
    Image<std::uint8_t> mask(depth.width, depth.height, 0);
    const auto compare = [&](int x, int y, int u, int v) {
        if (u >= depth.width || v >= depth.height) return;
        const float a = depth.at(x, y), b = depth.at(u, v);
        if (a > 0.0f && b > 0.0f && std::abs(a - b) > jump(std::min(a, b))) mask.at(x, y) = mask.at(u, v) = 1;
    };
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) {
            compare(x, y, x + 1, y);
            compare(x, y, x, y + 1);
        }
    if (radius > 0) dilate(mask, radius);
    return mask;
}

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
        images.near_edge = near_depth_edges(images.depth, params.jump_radius, [&](double z) {
            return std::max(params.depth_jump, 3.0 * scene.depth_sigma(z));
        });
        progress.step();
    });
    return scene;
}

} // namespace quoin
