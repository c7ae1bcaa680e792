#include "fusion/depth_view.h"

#include "fusion/padded_depth.h"
#include "fusion/register_color.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

std::size_t index_of(const Camera& camera, int x, int y)
{
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
}

PaddedDepth within_range(const DepthImage& depth, const ViewParams& params)
{
    PaddedDepth kept(depth.width, depth.height);
    const auto near = static_cast<float>(params.min_depth), far = static_cast<float>(params.max_depth);
    for (int y = 0; y < depth.height; ++y) {
        const float* from = depth.row(y);
        float* to = kept.row(y);
        for (int x = 0; x < depth.width; ++x)
            to[x] = ((from[x] >= near) & (from[x] <= far)) ? from[x] : 0.0f; // NaN is in no range
    }
    return kept;
}

// Drops the pixels whose depth jumps to that of one of their four neighbours: they measure the air between two
// surfaces.
PaddedDepth without_edges(const PaddedDepth& depth, float ratio)
{
    PaddedDepth kept(depth.width(), depth.height());
    for (int y = 0; y < depth.height(); ++y) {
        const float *z = depth.row(y), *above = depth.row(y - 1), *below = depth.row(y + 1);
        float* to = kept.row(y);
        for (int x = 0; x < depth.width(); ++x) {
            const float own = z[x], jump = ratio * own;
            const auto jumps = [&](float other) { return (other > 0.0f) & (std::abs(other - own) > jump); };
            const bool edge = jumps(z[x - 1]) | jumps(z[x + 1]) | jumps(above[x]) | jumps(below[x]);
            to[x] = edge ? 0.0f : own;
        }
    }
    return kept;
}

// Change of depth a pixel [m/px] along a line of pixels at `z`, `step` floats apart: between the farthest pixels that
// are connected to the middle. A lone pixel is as steep as can be.
inline float slope(const float* z, std::ptrdiff_t step)
{
    const float a1 = z[step], a2 = z[2 * step], a3 = z[3 * step];
    const float b1 = z[-step], b2 = z[-2 * step], b3 = z[-3 * step];
    const bool far_a = (a1 > 0.0f) & (a2 > 0.0f) & (a3 > 0.0f), far_b = (b1 > 0.0f) & (b2 > 0.0f) & (b3 > 0.0f);
    const float near_a = a1 > 0.0f ? a1 : z[0], near_b = b1 > 0.0f ? b1 : z[0];
    const float steps_a = far_a ? 3.0f : (a1 > 0.0f ? 1.0f : 0.0f), steps_b = far_b ? 3.0f : (b1 > 0.0f ? 1.0f : 0.0f);
    const float ahead = far_a ? a3 : near_a, behind = far_b ? b3 : near_b;
    const float steps = steps_a + steps_b;
    return steps > 0.0f ? (ahead - behind) / steps : z[0];
}

// Cosine between the rays of a row of pixels and the normals of the depth surface. With p(u, v) = z(u, v) r(u, v) and
// the ray r = ((u - cx) / fx, (v - cy) / fy, 1), the normal is n ~ (-fx z_u, -fy z_v, z + (u - cx) z_u + (v - cy) z_v),
// so n . r = z.
void incidence_of_row(const PaddedDepth& depth, const Camera& camera, int y, std::vector<float>& cosine)
{
    const float* z = depth.row(y);
    const std::ptrdiff_t down = depth.row(y + 1) - z;
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy),
               cx = static_cast<float>(camera.cx);
    const float dv = static_cast<float>(y - camera.cy), ray_y = dv / fy;
    for (int x = 0; x < depth.width(); ++x) {
        const float du = static_cast<float>(x) - cx, ray_x = du / fx;
        const float zu = slope(z + x, 1), zv = slope(z + x, down);
        const float nx = fx * zu, ny = fy * zv, nz = z[x] + du * zu + dv * zv;
        cosine[static_cast<std::size_t>(x)] =
            z[x] / std::sqrt((nx * nx + ny * ny + nz * nz) * (1.0f + ray_x * ray_x + ray_y * ray_y));
    }
}

// Keeps the pixels that measure a surface from not too far aside, and stores their incidence.
void keep_surface(const PaddedDepth& measured, const ViewParams& params, DepthView& view)
{
    const PaddedDepth depth = without_edges(measured, static_cast<float>(params.depth_edge));
    const auto least = static_cast<float>(params.min_incidence);
    std::vector<float> cosine(static_cast<std::size_t>(depth.width()));
    for (int y = 0; y < depth.height(); ++y) {
        incidence_of_row(depth, view.camera, y, cosine);
        const float* z = depth.row(y);
        const std::size_t first = index_of(view.camera, 0, y);
        for (std::size_t x = 0; x < cosine.size(); ++x) {
            const bool keep = (z[x] > 0.0f) & (cosine[x] >= least);
            view.depth[first + x] = keep ? z[x] : 0.0f;
            const float stored = std::max(1.0f, std::min(cosine[x], 1.0f) * kIncidenceScale);
            view.surface[first + x].incidence =
                keep ? static_cast<std::uint8_t>(static_cast<std::int32_t>(stored)) : std::uint8_t{0};
        }
    }
}

Image<float> tile_maxima(const DepthView& view)
{
    const Camera& camera = view.camera;
    Image<float> tiles((camera.width + kTile - 1) / kTile, (camera.height + kTile - 1) / kTile, 0.0f);
    for (int y = 0; y < camera.height; ++y) {
        const float* z = view.depth.data() + index_of(camera, 0, y);
        for (int x = 0; x < camera.width; ++x) {
            float& largest = tiles.at(x / kTile, y / kTile);
            largest = std::max(largest, z[x]);
        }
    }
    return tiles;
}

BlockCoord block_of(const Eigen::Vector3f& p_blocks)
{
    return {static_cast<int>(std::floor(p_blocks.x())), static_cast<int>(std::floor(p_blocks.y())),
            static_cast<int>(std::floor(p_blocks.z()))};
}

// Visits the blocks of a segment, given in units of blocks (Amanatides and Woo 1987).
template <class Visit>
void walk(const Eigen::Vector3f& start, const Eigen::Vector3f& end, const Visit& visit)
{
    BlockCoord cell = block_of(start);
    const BlockCoord last = block_of(end);
    const Eigen::Vector3f direction = end - start;
    visit(cell);
    for (int steps = (last - cell).cwiseAbs().sum(); steps > 0; --steps) {
        int axis = -1;
        float nearest = kFar;
        for (int k = 0; k < 3; ++k) {
            if (cell[k] == last[k]) continue;
            const float wall = static_cast<float>(cell[k] + (direction[k] > 0.0f ? 1 : 0));
            const float t = (wall - start[k]) / direction[k];
            if (t < nearest || axis < 0) {
                nearest = t;
                axis = k;
            }
        }
        cell[axis] += last[axis] > cell[axis] ? 1 : -1;
        visit(cell);
    }
}

// Keys without most of their repetitions: those that were added a short while ago are known.
class NewKeys {
public:
    void add(BlockKey key)
    {
        BlockKey& known = recent_[key % recent_.size()];
        if (known == key) return;
        known = key;
        keys_.push_back(key);
    }
    std::vector<BlockKey> sorted()
    {
        std::sort(keys_.begin(), keys_.end());
        keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
        return std::move(keys_);
    }

private:
    std::array<BlockKey, 4096> recent_{}; // by the low bits of the Morton code; no block has key 0
    std::vector<BlockKey> keys_;
};

// The pieces of the rays of a row of pixels that lie near the surface, in units of blocks.
struct RaySegments {
    explicit RaySegments(std::size_t rays)
    {
        for (std::size_t k = 0; k < 3; ++k) {
            start[k].resize(rays), end[k].resize(rays);
            start_block[k].resize(rays), end_block[k].resize(rays);
        }
    }
    std::array<std::vector<float>, 3> start, end; // [axis][ray]
    std::array<std::vector<std::int32_t>, 3> start_block, end_block;

    Eigen::Vector3f start_of(std::size_t i) const { return {start[0][i], start[1][i], start[2][i]}; }
    Eigen::Vector3f end_of(std::size_t i) const { return {end[0][i], end[1][i], end[2][i]}; }
    BlockCoord start_block_of(std::size_t i) const { return {start_block[0][i], start_block[1][i], start_block[2][i]}; }
    BlockCoord end_block_of(std::size_t i) const { return {end_block[0][i], end_block[1][i], end_block[2][i]}; }
};

constexpr int kStride = 2; // [px]; blocks are many pixels wide

// From measured points to the segments around them.
class RayCaster {
public:
    RayCaster(const DepthView& view, double block_size, const Truncation& truncation)
        : view_(view), truncation_(truncation),
          rays_((static_cast<std::size_t>(view.camera.width) + kStride - 1) / kStride), z_(rays_), ray_x_(rays_),
          reach_(rays_)
    {
        const Rigid world_from_camera = view.camera_from_world.inverse();
        blocks_from_camera_ = (world_from_camera.linear() / block_size).cast<float>();
        const Eigen::Vector3d offset = Eigen::Vector3d::Constant(kLatticeOffset / kBlockSide);
        eye_ = (world_from_camera.translation() / block_size - offset).cast<float>();
    }
    std::size_t rays() const { return rays_; }
    bool measured(std::size_t i) const { return z_[i] > 0.0f; } // did the row that was cast last?

    void cast(int y, RaySegments& segments)
    {
        const Camera& camera = view_.camera;
        const float* depth = view_.depth.data() + index_of(camera, 0, y);
        const auto inverse_fx = static_cast<float>(1.0 / camera.fx), cx = static_cast<float>(camera.cx);
        const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
        for (std::size_t i = 0; i < rays_; ++i) {
            z_[i] = depth[kStride * i];
            const float ray_x = (static_cast<float>(static_cast<std::int32_t>(kStride * i)) - cx) * inverse_fx;
            ray_x_[i] = ray_x;
            reach_[i] = truncation_.at(z_[i]) / std::sqrt(1.0f + ray_x * ray_x + ray_y * ray_y);
        }
        const Eigen::Vector3f base = blocks_from_camera_.col(1) * ray_y + blocks_from_camera_.col(2);
        for (int k = 0; k < 3; ++k)
            cast_axis(base[k], blocks_from_camera_(k, 0), eye_[k], static_cast<std::size_t>(k), segments);
    }

private:
    void cast_axis(float base, float step, float eye, std::size_t k, RaySegments& segments) const
    {
        float *start = segments.start[k].data(), *end = segments.end[k].data();
        std::int32_t *start_block = segments.start_block[k].data(), *end_block = segments.end_block[k].data();
        const float *z = z_.data(), *ray_x = ray_x_.data(), *reach = reach_.data();
        for (std::size_t i = 0; i < rays_; ++i) {
            const float direction = base + ray_x[i] * step;
            start[i] = eye + direction * (z[i] - reach[i]);
            end[i] = eye + direction * (z[i] + reach[i]);
            start_block[i] = static_cast<std::int32_t>(std::floor(start[i]));
            end_block[i] = static_cast<std::int32_t>(std::floor(end[i]));
        }
    }

    const DepthView& view_;
    Truncation truncation_;
    std::size_t rays_; // of a row
    std::vector<float> z_, ray_x_, reach_;
    Eigen::Matrix3f blocks_from_camera_;
    Eigen::Vector3f eye_; // [blocks]
};

} // namespace

DepthView make_view(const Scan& scan, FrameId id, const DepthImage& depth, const ColorImage& color,
                    const ViewParams& params)
{
    DepthView view;
    view.camera = scan.depth;
    view.camera_from_world = scan.frames[id].camera_from_world;
    view.depth.assign(depth.pixels.size() + 1, 0.0f);
    view.surface.assign(depth.pixels.size() + 1, PixelSurface{});
    const PaddedDepth measured = within_range(depth, params);
    keep_surface(measured, params, view);
    if (!color.empty()) register_color(scan, measured, color, params, view);
    view.tile_max = tile_maxima(view);
    return view;
}

std::vector<BlockKey> blocks_near_surface(const DepthView& view, double block_size, const Truncation& truncation)
{
    RayCaster caster(view, block_size, truncation);
    RaySegments segments(caster.rays());
    NewKeys keys;
    BlockCoord first = BlockCoord::Constant(std::numeric_limits<int>::max()), last = first;
    for (int y = 0; y < view.camera.height; y += kStride) {
        caster.cast(y, segments);
        for (std::size_t i = 0; i < caster.rays(); ++i) {
            if (!caster.measured(i)) continue;
            const BlockCoord start_block = segments.start_block_of(i), end_block = segments.end_block_of(i);
            const bool one_axis =
                ((end_block - start_block).array() != 0).count() <= 1; // then the way is the same, too
            if (one_axis && start_block == first && end_block == last) continue;
            first = start_block;
            last = end_block;
            walk(segments.start_of(i), segments.end_of(i),
                 [&](const BlockCoord& block) { keys.add(block_key(block)); });
        }
    }
    return keys.sorted();
}

} // namespace quoin
