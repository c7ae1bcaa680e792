#include "alignment/observations.h"

#include "base/parallel.h"
#include "image/sampling.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace quoin {
namespace {

constexpr int kRasterLevel = 1; // visibility is rendered at half the size: its edges are dilated anyway

// What one frame sees.
struct FrameView {
    const AlignmentScene& scene;
    std::size_t frame;
    Rigid depth_from_world, depth_from_color;
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
    return near_depth_edges(depth, radius, {.least = scene.params.depth_jump});
}

FrameView look(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, int level)
{
    FrameView view{scene,
                   k,
                   state.camera_from_world[k],
                   state.color.color_from_depth.inverse(),
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

// A plane as the frame of a view sees it; points come to the cameras by way of their projection onto it.
struct PlaneView {
    PlaneId id;
    Eigen::Affine3d color_from_point;
    double distance; // of the colour camera [m], > 0 before the plane
};

PlaneView plane_view(const FrameView& view, const CenteredPlane& plane, PlaneId id)
{
    const Rigid color_from_world = view.color.color_from_depth * view.depth_from_world;
    return {id, color_from_world * plane.projection(), plane.signed_distance(color_from_world.inverse().translation())};
}

int nearest_pixel(double u) { return static_cast<int>(u + 0.5); } // u >= 0

bool nearest_in_rendering(const FrameView& view, PlaneId plane, const Vector3& p_color)
{
    const Eigen::Vector2d u = view.raster_camera.project(p_color);
    if (!view.raster_camera.contains(u)) return false;
    const int x = nearest_pixel(u.x()), y = nearest_pixel(u.y());
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
    const int x = nearest_pixel(u.x()), y = nearest_pixel(u.y());
    if (images.near_edge.at(x, y)) return false;
    const double z = images.depth.at(x, y);
    const double tolerance = std::max(view.scene.params.depth_tolerance, 3.0 * view.scene.depth_sigma(p_depth.z()));
    return z <= 0.0 || std::abs(z - p_depth.z()) <= tolerance;
}

// Most texels of a plane fall to the first two tests.
bool sees(const FrameView& view, const PlaneView& plane, const Eigen::Vector3f& p_world)
{
    const OptimizeTextureParams& params = view.scene.params;
    const Vector3 p_color = plane.color_from_point * p_world.cast<double>();
    if (p_color.z() < params.min_depth || p_color.z() > params.max_depth) return false;
    const Eigen::Vector2d u = view.level_camera.project(p_color);
    const double border = std::max(1.0, params.border / (1 << view.level));
    if (!view.level_camera.contains(u, border)) return false;
    if (plane.distance < params.min_cosine * p_color.norm()) return false;
    if (!nearest_in_rendering(view, plane.id, p_color)) return false;
    if (!agrees_with_depth(view, view.depth_from_color * p_color)) return false;
    const float gray =
        sample_gray(view.scene.images[view.frame].gray[static_cast<std::size_t>(view.level)], u.x(), u.y()).value;
    return gray >= params.saturation && gray <= 1.0 - params.saturation;
}

std::vector<TexelId> visible_texels(const FrameView& view, const AlignmentState& state, const Texels& texels)
{
    std::vector<TexelId> visible;
    for (PlaneId p = 0; p < state.plane.size(); ++p) {
        if (!view.has_plane[p]) continue;
        const PlaneView plane = plane_view(view, state.plane[p], p);
        if (plane.distance < 0.0) continue;
        for (TexelId t = texels.first_of_plane[p]; t < texels.first_of_plane[p + 1]; ++t)
            if (sees(view, plane, texels.p_world[t])) visible.push_back(t);
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
    return {p.cast<float>(), scene.mesh.face_plane[seen.face.at(u, v)], static_cast<float>(1.0 / sigma)};
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
    return samples;
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

void DepthSamples::add(std::uint32_t frame, std::vector<DepthSample> samples)
{
    std::ranges::stable_sort(samples, {}, &DepthSample::plane);
    for (const DepthSample& sample : samples) {
        const auto at = static_cast<std::uint32_t>(size());
        if (run.empty() || run.back().frame != frame || run.back().plane != sample.plane)
            run.push_back({frame, at, at, sample.plane});
        run.back().end = at + 1;
        x.push_back(sample.p_camera.x());
        y.push_back(sample.p_camera.y());
        z.push_back(sample.p_camera.z());
        inverse_sigma.push_back(sample.inverse_sigma);
    }
}

DepthSamples sample_depths(const AlignmentScene& scene, const AlignmentState& state)
{
    std::vector<std::vector<DepthSample>> samples(scene.frames());
    parallel_for(samples.size(), [&](std::size_t k) { samples[k] = sample_frame(scene, state, k); });
    DepthSamples result;
    for (std::uint32_t k = 0; k < samples.size(); ++k)
        result.add(k, std::move(samples[k]));
    return result;
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
