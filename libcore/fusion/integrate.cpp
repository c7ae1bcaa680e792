// Notation: d measured depth, z depth of the voxel, s signed distance along the ray [m], w weight of an observation.
#include "fusion/integrate.h"

#include "base/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace quoin {
namespace {

constexpr float kNear = 0.05f; // voxels nearer to the camera plane are not seen [m]

// Sums over observations of one block, in floats.
struct Sums {
    alignas(32) std::array<float, kBlockVoxels> distance; // of w * s / truncation
    alignas(32) std::array<float, kBlockVoxels> weight;
    alignas(32) std::array<std::array<float, kBlockVoxels>, 3> color;
    alignas(32) std::array<float, kBlockVoxels> color_weight;
};

void unpack(const VoxelBlock& block, Sums& sums)
{
    for (std::size_t i = 0; i < kBlockVoxels; ++i) {
        sums.weight[i] = block.weight[i];
        sums.distance[i] = static_cast<float>(block.distance[i]) * block.weight[i] * (1.0f / kDistanceScale);
        sums.color_weight[i] = block.color_weight[i];
    }
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < kBlockVoxels; ++i)
            sums.color[c][i] = static_cast<float>(block.color[c][i]) * block.color_weight[i] * (1.0f / kColorScale);
}

void pack(const Sums& sums, VoxelBlock& block)
{
    constexpr float kTiny = 1e-12f;
    for (std::size_t i = 0; i < kBlockVoxels; ++i) {
        block.weight[i] = sums.weight[i];
        const float mean = sums.distance[i] / std::max(sums.weight[i], kTiny) * kDistanceScale;
        const float clamped = std::min(std::max(mean, -kDistanceScale), kDistanceScale);
        block.distance[i] = static_cast<std::int16_t>(static_cast<int>(clamped + (clamped < 0.0f ? -0.5f : 0.5f)));
        block.color_weight[i] = sums.color_weight[i];
    }
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < kBlockVoxels; ++i) {
            const float mean = sums.color[c][i] / std::max(sums.color_weight[i], kTiny) * kColorScale;
            block.color[c][i] = static_cast<std::uint16_t>(static_cast<int>(std::min(mean, 65535.0f)));
        }
    }
}

// A view with the projection in floats.
struct Projector {
    explicit Projector(const DepthView& v, double voxel_size)
        : view(&v), fx(float(v.camera.fx)), fy(float(v.camera.fy)), cx(float(v.camera.cx)), cy(float(v.camera.cy)),
          width(float(v.camera.width)), height(float(v.camera.height)),
          step((v.camera_from_world.linear() * voxel_size).cast<float>())
    {
    }
    const DepthView* view;
    float fx, fy, cx, cy;
    float width, height;
    Eigen::Matrix3f step; // columns: one voxel along x, y, z, in the camera [m]
};

// Can the view see the ball around a block, in front of or near a measured surface?
bool sees(const Projector& p, const Eigen::Vector3f& center, float radius, const Truncation& truncation)
{
    const float near = center.z() - radius, far = center.z() + radius;
    if (far < kNear) return false;
    const auto& tiles = p.view->tile_max;
    int x0 = 0, y0 = 0, x1 = tiles.width - 1, y1 = tiles.height - 1;
    if (near >= kNear) {
        const auto low = [&](float c) { return std::min((c - radius) / near, (c - radius) / far); };
        const auto high = [&](float c) { return std::max((c + radius) / near, (c + radius) / far); };
        const float u0 = p.fx * low(center.x()) + p.cx - 1.0f, u1 = p.fx * high(center.x()) + p.cx + 1.0f;
        const float v0 = p.fy * low(center.y()) + p.cy - 1.0f, v1 = p.fy * high(center.y()) + p.cy + 1.0f;
        if (u1 < 0.0f || v1 < 0.0f || u0 >= p.width || v0 >= p.height) return false;
        x0 = static_cast<int>(std::max(u0, 0.0f)) / kTile;
        y0 = static_cast<int>(std::max(v0, 0.0f)) / kTile;
        x1 = static_cast<int>(std::min(u1, p.width - 1.0f)) / kTile;
        y1 = static_cast<int>(std::min(v1, p.height - 1.0f)) / kTile;
    }
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x)
            if (const float z = tiles.at(x, y); z > 0.0f && z + truncation.at(z) > near) return true;
    return false;
}

// One layer of voxels, x + 8 y, seen by one view. Long enough that the compiler vectorises loops over it.
constexpr std::size_t kLayer = kBlockSide * kBlockSide;
template <class T>
using LayerOf = std::array<T, kLayer>;

struct Layer {
    alignas(32) LayerOf<float> z;     // [m]
    alignas(32) LayerOf<float> aside; // squared distance to the optical axis [m^2]
    alignas(32) LayerOf<std::uint32_t> pixel;
    alignas(32) LayerOf<float> depth;    // [m]
    alignas(32) LayerOf<float> distance; // [m], along the ray
    alignas(32) LayerOf<float> weight;
    alignas(32) LayerOf<std::uint32_t> surface; // PixelSurface: incidence, blue, green, red from the high byte
};
static_assert(sizeof(PixelSurface) == sizeof(std::uint32_t) && std::endian::native == std::endian::little);

void project(const Projector& p, const Eigen::Vector3f& start, Layer& layer)
{
    const auto missing = static_cast<std::int32_t>(p.view->depth.size() - 1);
    const auto width = static_cast<std::int32_t>(p.width);
    const Eigen::Vector3f dx = p.step.col(0), dy = p.step.col(1);
    alignas(32) LayerOf<std::int32_t> pixel;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(kLayer); ++i) {
        const std::int32_t ix = i % kBlockSide, iy = i / kBlockSide;
        const auto nx = static_cast<float>(ix), ny = static_cast<float>(iy);
        const float x = start.x() + nx * dx.x() + ny * dy.x(), y = start.y() + nx * dx.y() + ny * dy.y();
        const float z = start.z() + nx * dx.z() + ny * dy.z();
        const float inverse = 1.0f / z;
        const float u = p.fx * x * inverse + (p.cx + 0.5f), v = p.fy * y * inverse + (p.cy + 0.5f);
        const bool inside = (z > kNear) & (u >= 0.0f) & (v >= 0.0f) & (u < p.width) & (v < p.height);
        const auto column = static_cast<std::int32_t>(inside ? u : 0.0f);
        const auto line = static_cast<std::int32_t>(inside ? v : 0.0f);
        const auto n = static_cast<std::size_t>(i);
        pixel[n] = inside ? line * width + column : missing;
        layer.z[n] = z;
        layer.aside[n] = x * x + y * y;
    }
    for (std::size_t i = 0; i < kLayer; ++i)
        layer.pixel[i] = static_cast<std::uint32_t>(pixel[i]);
}

// Looks up depths; false if all lie more than the truncation in front of their voxels. Distances along the ray are not
// shorter, so that layers of which the view says nothing need no square roots.
bool look_up(const DepthView& view, const Truncation& truncation, Layer& layer)
{
    for (std::size_t i = 0; i < kLayer; ++i)
        layer.depth[i] = view.depth[layer.pixel[i]];
    std::int32_t near = 0;
    for (std::size_t i = 0; i < kLayer; ++i)
        near += ((layer.depth[i] > 0.0f) & (layer.depth[i] - layer.z[i] > -truncation.at(layer.depth[i]))) ? 1 : 0;
    return near > 0;
}

// Signed distances; false if the view says nothing about any voxel of the layer.
bool measure(const Truncation& truncation, Layer& layer)
{
    std::int32_t known = 0;
    for (std::size_t i = 0; i < kLayer; ++i) {
        const float z = layer.z[i],
                    stretch = std::sqrt(layer.aside[i] + z * z) * (1.0f / z); // of the ray to unit depth
        const float s = (layer.depth[i] - z) * stretch;
        layer.distance[i] = s;
        known += ((layer.depth[i] > 0.0f) & (s > -truncation.at(layer.depth[i]))) ? 1 : 0;
    }
    return known > 0;
}

// Weight: cosine of incidence / d^2, on both sides of the surface alike: with less of it behind, rays that pass a cup
// or look into it carve its wall away. Returns whether a voxel is near enough to take a colour.
bool accumulate_distance(const Truncation& truncation, Layer& layer, float* __restrict distance,
                         float* __restrict weight)
{
    std::int32_t near = 0;
    for (std::size_t i = 0; i < kLayer; ++i) {
        const float s = layer.distance[i], d = layer.depth[i], reach = truncation.at(d);
        const bool known = (d > 0.0f) & (s > -reach);
        const auto incidence = static_cast<std::int32_t>(layer.surface[i] >> 24 & ~std::uint32_t{kHasColor});
        const float cosine = static_cast<float>(incidence) * (1.0f / kIncidenceScale);
        const float w = known ? cosine / (d * d) : 0.0f;
        layer.weight[i] = w;
        distance[i] += known ? w * std::min(1.0f, s / reach) : 0.0f; // s is not finite beside the camera
        weight[i] += w;
        near += (known & (s < reach)) ? 1 : 0;
    }
    return near > 0;
}

void accumulate_color(const Truncation& truncation, const Layer& layer, Sums& sums, std::size_t at)
{
    alignas(32) LayerOf<float> weight;
    for (std::size_t i = 0; i < kLayer; ++i) {
        const float closeness = std::max(0.0f, 1.0f - std::abs(layer.distance[i]) / truncation.at(layer.depth[i]));
        const auto has_color = static_cast<float>(static_cast<std::int32_t>(layer.surface[i] >> 31));
        weight[i] = has_color * layer.weight[i] * closeness;
    }
    float* __restrict total = sums.color_weight.data() + at;
    for (std::size_t i = 0; i < kLayer; ++i)
        total[i] += weight[i];
    for (std::uint32_t c = 0; c < 3; ++c) {
        float* __restrict color = sums.color[c].data() + at;
        for (std::size_t i = 0; i < kLayer; ++i)
            color[i] += weight[i] * static_cast<float>(static_cast<std::int32_t>(layer.surface[i] >> (8 * c) & 255u));
    }
}

void add_view(const Projector& p, const Eigen::Vector3f& origin, const Truncation& truncation, Sums& sums)
{
    Layer layer;
    const DepthView& view = *p.view;
    for (int z = 0; z < kBlockSide; ++z) {
        project(p, origin + static_cast<float>(z) * p.step.col(2), layer);
        if (!look_up(view, truncation, layer) || !measure(truncation, layer)) continue;
        for (std::size_t i = 0; i < kLayer; ++i)
            layer.surface[i] = std::bit_cast<std::uint32_t>(view.surface[layer.pixel[i]]);
        const std::size_t at = kLayer * static_cast<std::size_t>(z);
        const bool near = accumulate_distance(truncation, layer, sums.distance.data() + at, sums.weight.data() + at);
        if (near && view.has_color) accumulate_color(truncation, layer, sums, at);
    }
}

} // namespace

void integrate(VoxelGrid& grid, std::span<const DepthView> views, const Truncation& truncation)
{
    std::vector<Projector> projectors;
    for (const auto& view : views)
        projectors.emplace_back(view, grid.voxel_size());
    const auto radius = static_cast<float>(0.5 * std::sqrt(3.0) * grid.block_size());
    const auto update = [&](std::size_t id) {
        VoxelBlock& block = grid.block(static_cast<BlockId>(id));
        const Eigen::Vector3d origin_world =
            grid.position(grid.coord(static_cast<BlockId>(id)), Eigen::Vector3i::Zero());
        Sums sums;
        bool seen = false;
        for (const auto& p : projectors) {
            const Eigen::Vector3f origin = (p.view->camera_from_world * origin_world).cast<float>();
            const Eigen::Vector3f center = origin + p.step * Eigen::Vector3f::Constant(0.5f * kBlockSide);
            if (!sees(p, center, radius, truncation)) continue;
            if (!seen) unpack(block, sums);
            seen = true;
            add_view(p, origin, truncation, sums);
        }
        if (seen) pack(sums, block);
    };
    constexpr std::size_t kGrain = 32; // [blocks]
    parallel_for(grid.size(), update, kGrain);
}

} // namespace quoin
