#include "alignment/scene.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "image/sampling.h"

#include <algorithm>
#include <cmath>
#include <span>

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

// Pixels of a row from one on.
struct RowPixels {
    const float* depth;
    std::uint8_t* mask;
};

// Marks the edges between as many pixels of `a` and the neighbours `b`, on both sides, as `is_edge` has room for.
void mark_edges(RowPixels a, RowPixels b, std::span<int> is_edge, const DepthJump& jump)
{
    const auto least = static_cast<float>(jump.least), floor = static_cast<float>(jump.floor);
    const auto square = static_cast<float>(jump.square);
    for (std::size_t x = 0; x < is_edge.size(); ++x) {
        const float here = a.depth[x], there = b.depth[x];
        const float nearer = here < there ? here : there, step = here < there ? there - here : here - there;
        const float limit = floor + square * nearer * nearer;
        is_edge[x] = static_cast<int>((nearer > 0.0f) & (step > limit) & (step > least));
    }
    for (std::size_t x = 0; x < is_edge.size(); ++x)
        a.mask[x] = static_cast<std::uint8_t>(a.mask[x] | is_edge[x]);
    for (std::size_t x = 0; x < is_edge.size(); ++x)
        b.mask[x] = static_cast<std::uint8_t>(b.mask[x] | is_edge[x]);
}

} // namespace

Image<std::uint8_t> near_depth_edges(const DepthImage& depth, int radius, const DepthJump& jump)
{
    Image<std::uint8_t> mask(depth.width, depth.height, 0);
    std::vector<int> is_edge(static_cast<std::size_t>(depth.width));
    for (int y = 0; y < depth.height; ++y) {
        const RowPixels row{depth.row(y), mask.row(y)};
        mark_edges(row, {row.depth + 1, row.mask + 1}, std::span(is_edge).subspan(1), jump);
        if (y + 1 < depth.height) mark_edges(row, {depth.row(y + 1), mask.row(y + 1)}, is_edge, jump);
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
        images.near_edge =
            near_depth_edges(images.depth, params.jump_radius,
                             {params.depth_jump, 3.0 * params.depth_noise_floor, 3.0 * params.depth_noise});
        progress.step();
    });
    return scene;
}

} // namespace quoin
