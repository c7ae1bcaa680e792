#include "alignment/observations.h"

#include "base/lanes.h"
#include "base/parallel.h"
#include "image/sampling.h"
#include "render/rasterize.h"

#include <algorithm>
#include <bit>
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

// Coordinates of all texels, each by itself [m].
struct TexelLanes {
    std::vector<float> x, y, z;
};

TexelLanes texel_lanes(const Texels& texels)
{
    TexelLanes lanes;
    for (const Eigen::Vector3f& p : texels.p_world) {
        lanes.x.push_back(p.x());
        lanes.y.push_back(p.y());
        lanes.z.push_back(p.z());
    }
    return lanes;
}

// Which points lie before the camera and within its image? In single precision, and so with some room: most texels of a
// plane fall to this test, and the others are asked again.
struct Frustum {
    static constexpr float kRoom = 1.0f; // [px]
    Eigen::Matrix<float, 3, 4> color_from_point;
    float fx, fy, left, right, top, bottom; // the borders from the principal point [px]

    Frustum(const Camera& camera, const Eigen::Affine3d& color_from_point_)
        : color_from_point(color_from_point_.matrix().topRows<3>().cast<float>()), fx(static_cast<float>(camera.fx)),
          fy(static_cast<float>(camera.fy)), left(static_cast<float>(-camera.cx) - kRoom),
          right(static_cast<float>(camera.width - camera.cx) + kRoom), top(static_cast<float>(-camera.cy) - kRoom),
          bottom(static_cast<float>(camera.height - camera.cy) + kRoom)
    {
    }
    // A bit for each of the first eight of `count` points from `first` on.
    unsigned may_show(const TexelLanes& points, std::size_t first, std::size_t count) const
    {
        const Floats x = load_part(&points.x[first], count), y = load_part(&points.y[first], count);
        const Floats z = load_part(&points.z[first], count);
        const auto row = [&](int i) {
            const auto A = color_from_point.row(i);
            return A[0] * x + A[1] * y + A[2] * z + A[3];
        };
        const Floats X = fx * row(0), Y = fy * row(1), Z = row(2);
        const Ints shown = (Z > 0.0f) & (X > left * Z) & (X < right * Z) & (Y > top * Z) & (Y < bottom * Z);
        return bits(shown) & ((1u << std::min(count, kFloats)) - 1u);
    }
};

std::vector<TexelId> visible_texels(const FrameView& view, const AlignmentState& state, const Texels& texels,
                                    const TexelLanes& lanes)
{
    std::vector<TexelId> visible;
    for (PlaneId p = 0; p < state.plane.size(); ++p) {
        if (!view.has_plane[p]) continue;
        const PlaneView plane = plane_view(view, state.plane[p], p);
        if (plane.distance < 0.0) continue;
        const Frustum frustum(view.level_camera, plane.color_from_point);
        const TexelId end = texels.first_of_plane[p + 1];
        for (TexelId first = texels.first_of_plane[p]; first < end; first += kFloats)
            for (unsigned shown = frustum.may_show(lanes, first, end - first); shown != 0; shown &= shown - 1) {
                const TexelId t = first + static_cast<TexelId>(std::countr_zero(shown));
                if (sees(view, plane, texels.p_world[t])) visible.push_back(t);
            }
    }
    return visible;
}

// Lists by frame and by texel from the visible texels of every frame; texels for which `keep` is 0 are left out, others
// get the number `renumbered`.
Observations listed(const std::vector<std::vector<TexelId>>& visible, const std::vector<std::uint8_t>& keep,
                    const std::vector<TexelId>& renumbered)
{
    Observations result;
    result.first_of_frame.assign(visible.size() + 1, 0);
    const auto is_kept = [&](TexelId t) { return keep[t] != 0; };
    parallel_for(visible.size(), [&](std::size_t k) {
        result.first_of_frame[k + 1] = static_cast<std::uint32_t>(std::ranges::count_if(visible[k], is_kept));
    });
    std::partial_sum(result.first_of_frame.begin(), result.first_of_frame.end(), result.first_of_frame.begin());
    result.texel.resize(result.first_of_frame.back());
    result.frame.resize(result.texel.size());
    parallel_for(visible.size(), [&](std::size_t k) {
        std::size_t o = result.first_of_frame[k];
        for (const TexelId t : visible[k]) {
            if (!is_kept(t)) continue;
            result.texel[o] = renumbered[t];
            result.frame[o++] = static_cast<std::uint32_t>(k);
        }
    });
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
    const TexelLanes lanes = texel_lanes(texels);
    parallel_for(visible.size(), [&](std::size_t k) {
        visible[k] = visible_texels(look(scene, state, k, level), state, texels, lanes);
    });
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
