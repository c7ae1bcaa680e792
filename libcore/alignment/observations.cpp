#include "alignment/observations.h"

#include "base/parallel.h"
#include "image/sampling.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace quoin {
namespace {

constexpr int kRasterLevel = 1; // visibility is rendered at half the size: its edges are dilated anyway

// What one frame sees.
struct FrameView {
    const AlignmentScene& scene;
    std::size_t frame;
    Rigid depth_from_world;
    ColorCamera color;
    Camera raster_camera, level_camera;
    int level;
    Visibility seen;                     // at kRasterLevel, from the colour camera
    Image<std::uint8_t> near_edge;       // of `seen`
    std::vector<std::uint8_t> has_plane; // planes that `seen` shows
};

Image<std::uint8_t> rendered_edges(const AlignmentScene& scene, const DepthImage& depth)
{
    const int radius = (scene.params.jump_radius + 1) >> kRasterLevel;
    return near_depth_edges(depth, radius, [&](double) { return scene.params.depth_jump; });
}

FrameView look(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, int level)
{
    FrameView view{scene,
                   k,
                   state.camera_from_world[k],
                   state.color,
                   state.color.camera.at_level(kRasterLevel),
                   state.color.camera.at_level(level),
                   level,
                   {},
                   {},
                   {}};
    view.seen = rasterize(scene.mesh.mesh, view.raster_camera, view.color.color_from_depth * view.depth_from_world);
    view.near_edge = rendered_edges(scene, view.seen.depth);
    view.has_plane.assign(scene.mesh.plane.size(), 0);
    for (const FaceId f : view.seen.face.pixels)
        if (f != kNoFace) view.has_plane[scene.mesh.face_plane[f]] = 1;
    return view;
}

bool nearest_in_rendering(const FrameView& view, PlaneId plane, const Vector3& p_color)
{
    const Eigen::Vector2d u = view.raster_camera.project(p_color);
    if (!view.raster_camera.contains(u)) return false;
    const int x = static_cast<int>(std::lround(u.x())), y = static_cast<int>(std::lround(u.y()));
    const FaceId face = view.seen.face.at(x, y);
    if (face == kNoFace || view.near_edge.at(x, y)) return false;
    if (view.scene.mesh.face_plane[face] == plane) return true;
    return std::abs(view.seen.depth.at(x, y) - p_color.z()) <= view.scene.params.depth_tolerance;
}

bool agrees_with_depth(const FrameView& view, const Vector3& p_depth)
{
    const KeyframeImages& images = view.scene.images[view.frame];
    const Camera& camera = view.scene.depth_camera;
    if (images.depth.empty() || p_depth.z() <= 0.0) return true;
    const Eigen::Vector2d u = camera.project(p_depth);
    if (!camera.contains(u)) return true;
    const int x = static_cast<int>(std::lround(u.x())), y = static_cast<int>(std::lround(u.y()));
    if (images.near_edge.at(x, y)) return false;
    const double z = images.depth.at(x, y);
    const double tolerance = std::max(view.scene.params.depth_tolerance, 3.0 * view.scene.depth_sigma(p_depth.z()));
    return z <= 0.0 || std::abs(z - p_depth.z()) <= tolerance;
}

bool sees(const FrameView& view, const CenteredPlane& plane, PlaneId id, const Vector3& p_world)
{
    const OptimizeTextureParams& params = view.scene.params;
    const Vector3 p_depth = view.depth_from_world * plane.project(p_world);
    const Vector3 p_color = view.color.color_from_depth * p_depth;
    if (p_color.z() < params.min_depth || p_color.z() > params.max_depth) return false;
    const Eigen::Vector2d u = view.level_camera.project(p_color);
    const double border = std::max(1.0, params.border / (1 << view.level));
    if (!view.level_camera.contains(u, border)) return false;
    const Vector3 normal = view.color.color_from_depth.linear() * (view.depth_from_world.linear() * plane.normal);
    if (-normal.dot(p_color) < params.min_cosine * p_color.norm()) return false;
    if (!nearest_in_rendering(view, id, p_color) || !agrees_with_depth(view, p_depth)) return false;
    const float gray =
        sample_gray(view.scene.images[view.frame].gray[static_cast<std::size_t>(view.level)], u.x(), u.y()).value;
    return gray >= params.saturation && gray <= 1.0 - params.saturation;
}

std::vector<TexelId> visible_texels(const FrameView& view, const AlignmentState& state, const Texels& texels)
{
    std::vector<TexelId> visible;
    for (PlaneId p = 0; p < state.plane.size(); ++p) {
        if (!view.has_plane[p]) continue;
        for (TexelId t = texels.first_of_plane[p]; t < texels.first_of_plane[p + 1]; ++t)
            if (sees(view, state.plane[p], p, texels.p_world[t].cast<double>())) visible.push_back(t);
    }
    return visible;
}

// Lists by frame and by texel from the visible texels of every frame; texels for which `keep` is 0 are left out, others
// get the number `renumbered`.
Observations listed(const std::vector<std::vector<TexelId>>& visible, const std::vector<std::uint8_t>& keep,
                    const std::vector<TexelId>& renumbered)
{
    Observations result;
    result.first_of_frame.push_back(0);
    for (std::uint32_t k = 0; k < visible.size(); ++k) {
        for (const TexelId t : visible[k])
            if (keep[t]) {
                result.texel.push_back(renumbered[t]);
                result.frame.push_back(k);
            }
        result.first_of_frame.push_back(static_cast<std::uint32_t>(result.texel.size()));
    }
    const std::size_t texel_count = renumbered.empty() ? 0 : renumbered.back() + std::size_t{1};
    result.first_of_texel.assign(texel_count + 1, 0);
    for (const TexelId t : result.texel)
        ++result.first_of_texel[t + 1];
    std::partial_sum(result.first_of_texel.begin(), result.first_of_texel.end(), result.first_of_texel.begin());
    result.of_texel.resize(result.texel.size());
    auto next = result.first_of_texel;
    for (std::uint32_t o = 0; o < result.texel.size(); ++o)
        result.of_texel[next[result.texel[o]]++] = o;
    return result;
}

DepthSample sample_depth(const AlignmentScene& scene, const KeyframeImages& images, const Visibility& seen, int x,
                         int y)
{
    const double z = images.depth.at(x, y);
    const int u = x >> kRasterLevel, v = y >> kRasterLevel;
    if (z < scene.params.min_depth || z > scene.params.max_depth || images.near_edge.at(x, y)) return {};
    if (!seen.face.contains(u, v) || seen.face.at(u, v) == kNoFace) return {};
    const double sigma = scene.depth_sigma(z);
    if (std::abs(seen.depth.at(u, v) - z) > std::max(scene.params.depth_gate, 3.0 * sigma)) return {};
    const Vector3 p = scene.depth_camera.ray({x, y}) * z;
    return {p.cast<float>(), scene.mesh.face_plane[seen.face.at(u, v)], static_cast<float>(sigma)};
}

std::vector<DepthSample> sample_frame(const AlignmentScene& scene, const AlignmentState& state, std::size_t k)
{
    const KeyframeImages& images = scene.images[k];
    std::vector<DepthSample> samples;
    if (images.depth.empty()) return samples;
    const Rigid& camera_from_world = state.camera_from_world[k];
    const Visibility seen = rasterize(scene.mesh.mesh, scene.depth_camera.at_level(kRasterLevel), camera_from_world);
    const int stride = scene.params.depth_stride;
    for (int y = stride / 2; y < images.depth.height; y += stride)
        for (int x = stride / 2; x < images.depth.width; x += stride) {
            const DepthSample sample = sample_depth(scene, images, seen, x, y);
            if (sample.plane == kNoPlane) continue;
            const Vector3 normal = camera_from_world.linear() * state.plane[sample.plane].normal;
            const Vector3 p = sample.p_camera.cast<double>();
            if (-normal.dot(p) >= scene.params.min_cosine * p.norm()) samples.push_back(sample);
        }
    std::ranges::stable_sort(samples, {}, &DepthSample::plane);
    return samples;
}

// The mean length of the image gradient where the frames see a texel, for each texel.
std::vector<float> mean_gradients(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                  const Observations& observations, int level)
{
    const Camera camera = state.color.camera.at_level(level);
    const auto mean_of = [&](std::size_t t) {
        const std::uint32_t views = observations.views(static_cast<TexelId>(t));
        const Vector3 p_world = state.plane[texels.plane[t]].project(texels.p_world[t].cast<double>());
        double sum = 0.0;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const std::uint32_t k = observations.frame[observations.of_texel[i]];
            const Vector3 p_camera = state.camera_from_world[k] * p_world;
            const Eigen::Vector2d u = camera.project(state.color.color_from_depth * p_camera);
            const GraySample gray = sample_gray(scene.images[k].gray[static_cast<std::size_t>(level)], u.x(), u.y());
            sum += std::hypot(gray.gx, gray.gy);
        }
        return static_cast<float>(views > 0 ? sum / views : 0.0);
    };
    std::vector<float> mean(texels.size());
    parallel_for(
        mean.size(), [&](std::size_t t) { mean[t] = mean_of(t); }, 1024);
    return mean;
}

} // namespace

Observations observe(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels, int level)
{
    std::vector<std::vector<TexelId>> visible(scene.frames());
    parallel_for(visible.size(),
                 [&](std::size_t k) { visible[k] = visible_texels(look(scene, state, k, level), state, texels); });
    std::vector<std::uint32_t> views(texels.size(), 0);
    for (const auto& frame : visible)
        for (const TexelId t : frame)
            ++views[t];
    std::vector<std::uint8_t> shared(texels.size());
    std::ranges::transform(views, shared.begin(), [](std::uint32_t n) { return n >= 2; });
    std::vector<TexelId> same(texels.size());
    std::iota(same.begin(), same.end(), 0u);
    return listed(visible, shared, same);
}

DepthSamples sample_depths(const AlignmentScene& scene, const AlignmentState& state)
{
    std::vector<std::vector<DepthSample>> samples(scene.frames());
    parallel_for(samples.size(), [&](std::size_t k) { samples[k] = sample_frame(scene, state, k); });
    DepthSamples result;
    result.first_of_frame.push_back(0);
    for (const auto& frame : samples) {
        result.sample.insert(result.sample.end(), frame.begin(), frame.end());
        result.first_of_frame.push_back(static_cast<std::uint32_t>(result.sample.size()));
    }
    return result;
}

std::vector<std::uint8_t> select_texels(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                        const Observations& observations, int level)
{
    const OptimizeTextureParams& params = scene.params;
    const std::vector<float> gradient = mean_gradients(scene, state, texels, observations, level);
    const auto bucket_of = [&](TexelId t) {
        const auto floor_div = [&](int a) { return (a >= 0 ? a : a - params.bucket + 1) / params.bucket; };
        return std::tuple(texels.plane[t], floor_div(texels.cell[t][1]), floor_div(texels.cell[t][0]));
    };
    std::vector<TexelId> order;
    for (TexelId t = 0; t < texels.size(); ++t)
        if (observations.views(t) >= 2) order.push_back(t);
    std::ranges::sort(order, {}, [&](TexelId t) { return std::tuple(bucket_of(t), -gradient[t], t); });

    std::vector<std::uint8_t> keep(texels.size(), 0);
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && bucket_of(order[end]) == bucket_of(order[begin]))
            ++end;
        const auto best =
            begin + static_cast<std::size_t>(std::ceil(params.selected * static_cast<double>(end - begin)));
        for (std::size_t i = begin; i < best && gradient[order[i]] >= params.min_gradient; ++i)
            keep[order[i]] = 1;
    }
    const auto every =
        params.uniform > 0.0 ? static_cast<std::size_t>(std::ceil(1.0 / params.uniform)) : order.size() + 1;
    for (std::size_t i = every - 1; i < order.size(); i += every)
        keep[order[i]] = 1;
    return keep;
}

Observations kept(const Observations& observations, const std::vector<std::uint8_t>& keep)
{
    std::vector<std::vector<TexelId>> visible(observations.first_of_frame.size() - 1);
    std::vector<TexelId> number(keep.size());
    TexelId next = 0;
    for (std::size_t t = 0; t < keep.size(); ++t)
        number[t] = keep[t] ? next++ : next;
    for (std::size_t o = 0; o < observations.size(); ++o)
        visible[observations.frame[o]].push_back(observations.texel[o]);
    Observations result = listed(visible, keep, number);
    result.first_of_texel.resize(next + std::size_t{1}, static_cast<std::uint32_t>(result.size()));
    return result;
}

} // namespace quoin
