#include "alignment/sight.h"

#include "base/lanes.h"
#include "render/rasterize.h"

#include <algorithm>
#include <bit>

namespace quoin {
namespace {

using PointMap = Eigen::Matrix<float, 3, 4>; // of homogeneous points

PointMap point_map(const Eigen::Affine3d& map) { return map.matrix().topRows<3>().cast<float>(); }

struct PointLanes {
    Floats x, y, z;
};

PointLanes operator*(const PointMap& A, const PointLanes& p)
{
    const auto row = [&](int i) { return A(i, 0) * p.x + A(i, 1) * p.y + A(i, 2) * p.z + A(i, 3); };
    return {row(0), row(1), row(2)};
}

// A camera that eight points are before.
struct CameraLanes {
    int width = 0;
    float fx, fy, cx, cy, least, right, bottom; // [px], the borders of what is in the image

    CameraLanes(const Camera& camera, double border)
        : width(camera.width), fx(static_cast<float>(camera.fx)), fy(static_cast<float>(camera.fy)),
          cx(static_cast<float>(camera.cx)), cy(static_cast<float>(camera.cy)), least(static_cast<float>(border)),
          right(static_cast<float>(camera.width - 1 - border)), bottom(static_cast<float>(camera.height - 1 - border))
    {
    }
    struct Pixels {
        Floats u, v;
        Ints in_image;
    };
    Pixels project(const PointLanes& p) const
    {
        const Floats inverse = 1.0f / p.z;
        const Floats u = fx * (p.x * inverse) + cx, v = fy * (p.y * inverse) + cy;
        return {u, v, (p.z > 0.0f) & (u >= least) & (v >= least) & (u <= right) & (v <= bottom)};
    }
    // By rows; the first one of what is not in the image.
    Ints nearest(const Pixels& pixel) const
    {
        return (to_ints(pixel.v + 0.5f) & pixel.in_image) * width + (to_ints(pixel.u + 0.5f) & pixel.in_image);
    }
};

// What one frame sees.
struct FrameSight {
    const AlignmentScene& scene;
    const CornerImage& gray;
    const DepthImage& measured;
    CameraLanes color, raster, depth;
    DepthImage rendered;                 // at kRasterLevel, from the colour camera
    Image<PlaneId> plane;                // of `rendered`; kNoPlane near edges
    std::vector<std::uint8_t> has_plane; // planes that `rendered` shows
};

FrameSight look(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, int level)
{
    const OptimizeTextureParams& params = scene.params;
    const Camera raster = state.color.camera.at_level(kRasterLevel);
    Visibility seen = rasterize(scene.mesh.mesh, raster, state.color.color_from_depth * state.camera_from_world[k]);
    const double border = std::max(1.0, params.border / (1 << level));
    FrameSight sight{scene,
                     scene.images[k].gray[static_cast<std::size_t>(level)],
                     scene.images[k].depth,
                     {state.color.camera.at_level(level), border},
                     {raster, 0.0},
                     {scene.depth_camera, 0.0},
                     std::move(seen.depth),
                     {raster.width, raster.height, kNoPlane},
                     std::vector<std::uint8_t>(scene.mesh.plane.size(), 0)};
    for (std::size_t i = 0; i < seen.face.pixels.size(); ++i) {
        const FaceId face = seen.face.pixels[i];
        if (face == kNoFace) continue;
        sight.plane.pixels[i] = scene.mesh.face_plane[face];
        sight.has_plane[scene.mesh.face_plane[face]] = 1;
    }
    const int radius = (params.jump_radius + 1) >> kRasterLevel;
    for_each(near_depth_edges(sight.rendered, radius, {.least = params.depth_jump}),
             [&](int x, int y) { sight.plane.at(x, y) = kNoPlane; });
    return sight;
}

// A plane as the frame sees it; points come to the cameras by way of their projection onto it.
struct PlaneSight {
    const FrameSight& frame;
    PlaneId id;
    PointMap color_from_point, depth_from_color;
    float distance; // of the colour camera [m], > 0 before the plane

    PlaneSight(const FrameSight& frame_, const AlignmentState& state, std::size_t k, PlaneId id_)
        : frame(frame_), id(id_), depth_from_color(point_map(state.color.color_from_depth.inverse()))
    {
        const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[k];
        color_from_point = point_map(color_from_world * state.plane[id].projection());
        distance = static_cast<float>(state.plane[id].signed_distance(color_from_world.inverse().translation()));
    }

    Ints is_nearest_in_rendering(const PointLanes& p_color) const
    {
        const auto pixel = frame.raster.project(p_color);
        const Ints at = frame.raster.nearest(pixel);
        const Ints plane = gather(frame.plane.pixels.data(), at);
        const Floats difference = size_of(gather(frame.rendered.pixels.data(), at) - p_color.z);
        const Ints is_near = difference <= static_cast<float>(frame.scene.params.depth_tolerance);
        return pixel.in_image & (plane != static_cast<int>(kNoPlane)) & ((plane == static_cast<int>(id)) | is_near);
    }
    // So does a point whose depth was not measured.
    Ints agrees_with_depth(const PointLanes& p_depth) const
    {
        if (frame.measured.empty()) return Ints{} == Ints{};
        const auto pixel = frame.depth.project(p_depth);
        const Floats z = gather(frame.measured.pixels.data(), frame.depth.nearest(pixel));
        const OptimizeTextureParams& params = frame.scene.params;
        const Floats sigmas = 3.0f * static_cast<float>(params.depth_noise_floor) +
                              3.0f * static_cast<float>(params.depth_noise) * p_depth.z * p_depth.z;
        const Floats least = each(static_cast<float>(params.depth_tolerance));
        const Floats tolerance = sigmas > least ? sigmas : least;
        return ~pixel.in_image | (z == 0.0f) | ((z > 0.0f) & (size_of(z - p_depth.z) <= tolerance));
    }
    Ints is_not_saturated(const CameraLanes::Pixels& pixel) const
    {
        const Floats u = pixel.in_image ? pixel.u : Floats{}, v = pixel.in_image ? pixel.v : Floats{};
        const auto margin = static_cast<float>(frame.scene.params.saturation);
        const Floats gray = frame.gray.sample(frame.gray.place(u, v)).value;
        return (gray >= margin) & (gray <= 1.0f - margin);
    }
    // A bit for each of the first eight of `count` points from `first` on.
    unsigned sees(const TexelLanes& points, std::size_t first, std::size_t count) const
    {
        const OptimizeTextureParams& params = frame.scene.params;
        const PointLanes p_color =
            color_from_point * PointLanes{load_part(&points.x[first], count), load_part(&points.y[first], count),
                                          load_part(&points.z[first], count)};
        const auto pixel = frame.color.project(p_color);
        const Floats length = square_root(p_color.x * p_color.x + p_color.y * p_color.y + p_color.z * p_color.z);
        const Ints in_sight = pixel.in_image & (p_color.z >= static_cast<float>(params.min_depth)) &
                              (p_color.z <= static_cast<float>(params.max_depth)) &
                              (static_cast<float>(params.min_cosine) * length <= distance);
        const unsigned known = (1u << std::min(count, kFloats)) - 1u;
        if ((bits(in_sight) & known) == 0) return 0;
        return known & bits(in_sight & is_nearest_in_rendering(p_color) &
                            agrees_with_depth(depth_from_color * p_color) & is_not_saturated(pixel));
    }
    // Those of the points from `begin` to `end`.
    void add_visible(const TexelLanes& points, TexelId begin, TexelId end, std::vector<TexelId>& visible) const
    {
        for (TexelId first = begin; first < end; first += kFloats)
            for (unsigned seen = sees(points, first, end - first); seen != 0; seen &= seen - 1)
                visible.push_back(first + static_cast<TexelId>(std::countr_zero(seen)));
    }
};

} // namespace

TexelLanes texel_lanes(const Texels& texels)
{
    TexelLanes lanes;
    lanes.first_of_plane = texels.first_of_plane;
    for (auto* values : {&lanes.x, &lanes.y, &lanes.z})
        values->reserve(texels.size());
    for (const Eigen::Vector3f& p : texels.p_world) {
        lanes.x.push_back(p.x());
        lanes.y.push_back(p.y());
        lanes.z.push_back(p.z());
    }
    return lanes;
}

std::vector<TexelId> visible_texels(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, int level,
                                    const TexelLanes& texels)
{
    const FrameSight sight = look(scene, state, k, level);
    std::vector<TexelId> visible;
    for (PlaneId p = 0; p < state.plane.size(); ++p) {
        if (!sight.has_plane[p]) continue;
        const PlaneSight plane(sight, state, k, p);
        if (plane.distance < 0.0f) continue;
        plane.add_visible(texels, texels.first_of_plane[p], texels.first_of_plane[p + 1], visible);
    }
    return visible;
}

} // namespace quoin
