// Notation: d measured depth, z depth of the voxel, s signed distance along the ray [m], w weight of an observation.
#include "fusion/integrate.h"

#include "base/parallel.h"

#include <algorithm>
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
bool sees(const Projector& p, const Eigen::Vector3f& center, float radius, float truncation)
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
    const float needed = std::max(near - truncation, 0.0f);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x)
            if (tiles.at(x, y) > needed) return true;
    return false;
}

// One row of voxels along the world's x, seen by one view.
struct Row {
    alignas(32) std::array<float, kBlockSide> z;       // [m]
    alignas(32) std::array<float, kBlockSide> stretch; // length of the ray to unit depth
    alignas(32) std::array<std::uint32_t, kBlockSide> pixel;
    alignas(32) std::array<float, kBlockSide> depth;    // [m]
    alignas(32) std::array<float, kBlockSide> distance; // [m], along the ray
    alignas(32) std::array<float, kBlockSide> weight;
};

void project(const Projector& p, const Eigen::Vector3f& start, Row& row)
{
    const auto missing = static_cast<std::int32_t>(p.view->depth.size() - 1);
    const auto width = static_cast<std::int32_t>(p.width);
    const Eigen::Vector3f step = p.step.col(0);
    alignas(32) std::array<std::int32_t, kBlockSide> pixel;
    for (std::size_t i = 0; i < kBlockSide; ++i) {
        const auto n = static_cast<float>(static_cast<std::int32_t>(i));
        const float x = start.x() + n * step.x(), y = start.y() + n * step.y(), z = start.z() + n * step.z();
        const float inverse = 1.0f / z;
        const float u = p.fx * x * inverse + (p.cx + 0.5f), v = p.fy * y * inverse + (p.cy + 0.5f);
        const bool inside = (z > kNear) & (u >= 0.0f) & (v >= 0.0f) & (u < p.width) & (v < p.height);
        const auto column = static_cast<std::int32_t>(inside ? u : 0.0f),
                   line = static_cast<std::int32_t>(inside ? v : 0.0f);
        pixel[i] = inside ? line * width + column : missing;
        row.z[i] = z;
        row.stretch[i] = std::sqrt(x * x + y * y + z * z) * inverse;
    }
    for (std::size_t i = 0; i < kBlockSide; ++i)
        row.pixel[i] = static_cast<std::uint32_t>(pixel[i]);
}

// Distances and which voxels the view says something about; false if none.
bool measure(const Projector& p, float truncation, Row& row)
{
    for (std::size_t i = 0; i < kBlockSide; ++i)
        row.depth[i] = p.view->depth[row.pixel[i]];
    int known = 0;
    for (std::size_t i = 0; i < kBlockSide; ++i) {
        const float s = (row.depth[i] - row.z[i]) * row.stretch[i];
        row.distance[i] = s;
        known += (row.depth[i] > 0.0f) & (s > -truncation) ? 1 : 0;
    }
    return known > 0;
}

struct Reach {
    float truncation; // [m]
    float voxel_size; // [m]
};

// What the pixels of a row say of the surface.
struct RowSurface {
    alignas(32) std::array<float, kBlockSide> cosine;
    alignas(32) std::array<float, kBlockSide> has_color; // 0 or 1
    alignas(32) std::array<std::array<float, kBlockSide>, 3> color;
};

void look_up(const DepthView& view, const Row& row, RowSurface& surface)
{
    for (std::size_t i = 0; i < kBlockSide; ++i) {
        const PixelSurface pixel = view.surface[row.pixel[i]];
        surface.cosine[i] = static_cast<float>(pixel.incidence & ~kHasColor) * (1.0f / kIncidenceScale);
        surface.has_color[i] = static_cast<float>(pixel.incidence >> 7);
        for (std::size_t c = 0; c < 3; ++c)
            surface.color[c][i] = static_cast<float>(pixel.color[c]);
    }
}

// Weight: cosine of incidence / d^2; behind the surface it fades to 0 at the truncation, so that the back of a thin
// wall is not overwritten (Bylow et al. 2013). Returns whether a voxel is near enough to take a colour.
bool accumulate_distance(const RowSurface& surface, const Reach& reach, Row& row, float* __restrict distance,
                         float* __restrict weight)
{
    const float fade = 1.0f / (reach.truncation - reach.voxel_size), scale = 1.0f / reach.truncation;
    int near = 0;
    for (std::size_t i = 0; i < kBlockSide; ++i) {
        const float s = row.distance[i], d = row.depth[i];
        const bool known = (d > 0.0f) & (s > -reach.truncation);
        const float faded = surface.cosine[i] * std::min(1.0f, (reach.truncation + s) * fade) / (d * d);
        const float w = known ? faded : 0.0f;
        row.weight[i] = w;
        distance[i] += w * std::min(1.0f, s * scale);
        weight[i] += w;
        near += known & (s < reach.truncation) ? 1 : 0;
    }
    return near > 0;
}

void accumulate_color(const RowSurface& surface, const Reach& reach, const Row& row, Sums& sums, std::size_t at)
{
    const float scale = 1.0f / reach.truncation;
    alignas(32) std::array<float, kBlockSide> weight;
    for (std::size_t i = 0; i < kBlockSide; ++i) {
        const float closeness = std::max(0.0f, 1.0f - std::abs(row.distance[i]) * scale);
        weight[i] = surface.has_color[i] * row.weight[i] * closeness;
    }
    float* __restrict total = sums.color_weight.data() + at;
    for (std::size_t i = 0; i < kBlockSide; ++i)
        total[i] += weight[i];
    for (std::size_t c = 0; c < 3; ++c) {
        float* __restrict color = sums.color[c].data() + at;
        for (std::size_t i = 0; i < kBlockSide; ++i)
            color[i] += weight[i] * surface.color[c][i];
    }
}

void add_view(const Projector& p, const Eigen::Vector3f& origin, const Reach& reach, Sums& sums)
{
    Row row;
    RowSurface surface;
    for (int line = 0; line < kBlockSide * kBlockSide; ++line) {
        const auto y = static_cast<float>(line % kBlockSide), z = static_cast<float>(line / kBlockSide);
        project(p, origin + y * p.step.col(1) + z * p.step.col(2), row);
        if (!measure(p, reach.truncation, row)) continue;
        look_up(*p.view, row, surface);
        const auto at = static_cast<std::size_t>(line * kBlockSide);
        const bool near = accumulate_distance(surface, reach, row, sums.distance.data() + at, sums.weight.data() + at);
        if (near && p.view->has_color) accumulate_color(surface, reach, row, sums, at);
    }
}

} // namespace

void integrate(VoxelGrid& grid, std::span<const DepthView> views, double truncation)
{
    std::vector<Projector> projectors;
    for (const auto& view : views)
        projectors.emplace_back(view, grid.voxel_size());
    const Reach reach{static_cast<float>(truncation), static_cast<float>(grid.voxel_size())};
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
            if (!sees(p, center, radius, reach.truncation)) continue;
            if (!seen) unpack(block, sums);
            seen = true;
            add_view(p, origin, reach, sums);
        }
        if (seen) pack(sums, block);
    };
    constexpr std::size_t kGrain = 32; // [blocks]
    parallel_for(grid.size(), update, kGrain);
}

} // namespace quoin
