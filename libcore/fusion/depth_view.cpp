#include "fusion/depth_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();
std::size_t view_size(const Camera& camera)
{
    return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

std::size_t index_of(const Camera& camera, int x, int y)
{
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
}

constexpr int kReach = 3; // of a slope [px]: wide enough for the steps of a quantised sensor

// Depth with a margin of missing pixels, so that every pixel has all its neighbours.
class PaddedDepth {
public:
    PaddedDepth(int width, int height)
        : width_(width), height_(height), stride_(static_cast<std::size_t>(width + 2 * kReach)),
          z_(stride_ * static_cast<std::size_t>(height + 2 * kReach), 0.0f)
    {
    }
    int width() const { return width_; }
    int height() const { return height_; }
    float* row(int y) { return z_.data() + static_cast<std::size_t>(y + kReach) * stride_ + kReach; }
    const float* row(int y) const { return z_.data() + static_cast<std::size_t>(y + kReach) * stride_ + kReach; }

private:
    int width_, height_;
    std::size_t stride_;
    std::vector<float> z_; // [m]; 0 = missing
};

PaddedDepth within_range(const DepthImage& depth, const ViewParams& params)
{
    PaddedDepth kept(depth.width, depth.height);
    const auto near = static_cast<float>(params.min_depth), far = static_cast<float>(params.max_depth);
    for (int y = 0; y < depth.height; ++y) {
        const float* from = depth.row(y);
        float* to = kept.row(y);
        for (int x = 0; x < depth.width; ++x)
            to[x] = (from[x] >= near) & (from[x] <= far) ? from[x] : 0.0f; // NaN is in no range
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

// Where the depth pixels lie in the colour image; z = 0 where they are missing or outside it.
struct ColorPixels {
    std::vector<float> u, v; // [px]
    std::vector<float> z;    // [m], in the colour camera
};

ColorPixels project_into_color(const Scan& scan, const PaddedDepth& depth)
{
    const std::size_t count = view_size(scan.depth);
    ColorPixels pixels{std::vector<float>(count), std::vector<float>(count), std::vector<float>(count)};
    const Rigid color_from_depth = scan.depth_from_color.inverse();
    const Eigen::Matrix3f R = color_from_depth.linear().cast<float>();
    const Eigen::Vector3f t = color_from_depth.translation().cast<float>();
    const auto fx = static_cast<float>(scan.color.fx), fy = static_cast<float>(scan.color.fy);
    const auto cx = static_cast<float>(scan.color.cx), cy = static_cast<float>(scan.color.cy);
    const auto right = static_cast<float>(scan.color.width - 1), bottom = static_cast<float>(scan.color.height - 1);
    const auto inverse_fx = static_cast<float>(1.0 / scan.depth.fx), depth_cx = static_cast<float>(scan.depth.cx);
    for (int y = 0; y < depth.height(); ++y) {
        const float* z = depth.row(y);
        const auto ray_y = static_cast<float>((y - scan.depth.cy) / scan.depth.fy);
        const Eigen::Vector3f base = R.col(1) * ray_y + R.col(2), step = R.col(0);
        const std::size_t first = index_of(scan.depth, 0, y);
        float *u_row = pixels.u.data() + first, *v_row = pixels.v.data() + first, *z_row = pixels.z.data() + first;
        for (int x = 0; x < depth.width(); ++x) {
            const float ray_x = (static_cast<float>(x) - depth_cx) * inverse_fx;
            const float px = z[x] * (base.x() + ray_x * step.x()) + t.x(),
                        py = z[x] * (base.y() + ray_x * step.y()) + t.y();
            const float pz = z[x] * (base.z() + ray_x * step.z()) + t.z();
            const float u = fx * px / pz + cx, v = fy * py / pz + cy;
            const bool inside = (z[x] > 0.0f) & (pz > 0.0f) & (u >= 0.0f) & (v >= 0.0f) & (u < right) & (v < bottom);
            u_row[x] = inside ? u : 0.0f;
            v_row[x] = inside ? v : 0.0f;
            z_row[x] = inside ? pz : 0.0f;
        }
    }
    return pixels;
}

// Nearest depth in cells of the colour image, coarse enough that the depth pixels leave no holes in a surface.
class NearestDepth {
public:
    NearestDepth(const Scan& scan, const ColorPixels& pixels)
    {
        constexpr double kDepthPixels = 2.0; // across a cell
        const double cell = kDepthPixels * std::max(1.0, static_cast<double>(scan.color.width) / scan.depth.width);
        per_pixel_ = static_cast<float>(1.0 / cell);
        nearest_ = Image<float>(static_cast<int>(scan.color.width / cell) + 1,
                                static_cast<int>(scan.color.height / cell) + 1, kFar);
        for (std::size_t i = 0; i < pixels.z.size(); ++i) {
            if (pixels.z[i] <= 0.0f) continue;
            float& z = at(pixels.u[i], pixels.v[i]);
            z = std::min(z, pixels.z[i]);
        }
    }
    float& at(float u, float v)
    {
        return nearest_.at(static_cast<int>(u * per_pixel_), static_cast<int>(v * per_pixel_));
    }

private:
    float per_pixel_ = 1.0f; // cells
    Image<float> nearest_;
};

// Bilinear, with weights in 256ths; (u, v) is left of and above the last pixel.
Rgb8 sample(const ColorImage& image, float u, float v)
{
    const auto x = static_cast<int>(u), y = static_cast<int>(v);
    const int fx = static_cast<int>((u - static_cast<float>(x)) * 256.0f),
              fy = static_cast<int>((v - static_cast<float>(y)) * 256.0f);
    const Rgb8 *top = image.row(y) + x, *bottom = image.row(y + 1) + x;
    Rgb8 color;
    for (std::size_t c = 0; c < 3; ++c) {
        const int above = top[0][c] * (256 - fx) + top[1][c] * fx,
                  below = bottom[0][c] * (256 - fx) + bottom[1][c] * fx;
        color[c] = static_cast<std::uint8_t>((above * (256 - fy) + below * fy + (1 << 15)) >> 16);
    }
    return color;
}

// Gives every kept depth pixel the colour that the colour camera sees at its point, unless something hides the point
// there.
void register_color(const Scan& scan, const PaddedDepth& measured, const ColorImage& color, const ViewParams& params,
                    DepthView& view)
{
    const ColorPixels pixels = project_into_color(scan, measured);
    NearestDepth nearest(scan, pixels);
    const auto slack = static_cast<float>(params.occlusion), slack_ratio = static_cast<float>(params.depth_edge);
    for (std::size_t i = 0; i < pixels.z.size(); ++i) {
        const float u = pixels.u[i], v = pixels.v[i], z = pixels.z[i];
        if (view.depth[i] <= 0.0f || z <= 0.0f || z > nearest.at(u, v) + slack + slack_ratio * z) continue;
        view.surface[i].color = sample(color, u, v);
        view.surface[i].incidence |= kHasColor;
    }
    view.has_color = true;
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

std::vector<BlockKey> blocks_near_surface(const DepthView& view, double block_size, double truncation)
{
    constexpr int kStride = 2; // [px]; blocks are many pixels wide
    const Camera& camera = view.camera;
    const Rigid world_from_camera = view.camera_from_world.inverse();
    const Eigen::Matrix3f blocks_from_camera = (world_from_camera.linear() / block_size).cast<float>();
    const Eigen::Vector3d offset = Eigen::Vector3d::Constant(kLatticeOffset / kBlockSide);
    const Eigen::Vector3f eye = (world_from_camera.translation() / block_size - offset).cast<float>();
    const auto inverse_fx = static_cast<float>(1.0 / camera.fx), cx = static_cast<float>(camera.cx);
    NewKeys keys;
    BlockCoord first = BlockCoord::Constant(std::numeric_limits<int>::max()), last = first;
    for (int y = 0; y < camera.height; y += kStride) {
        const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
        const Eigen::Vector3f base = blocks_from_camera.col(1) * ray_y + blocks_from_camera.col(2);
        const float* depth = view.depth.data() + index_of(camera, 0, y);
        for (int x = 0; x < camera.width; x += kStride) {
            const float z = depth[x];
            if (z <= 0.0f) continue;
            const float ray_x = (static_cast<float>(x) - cx) * inverse_fx;
            const float reach = static_cast<float>(truncation) / std::sqrt(1.0f + ray_x * ray_x + ray_y * ray_y);
            const Eigen::Vector3f direction = base + ray_x * blocks_from_camera.col(0);
            const Eigen::Vector3f start = eye + direction * (z - reach), end = eye + direction * (z + reach);
            const BlockCoord start_block = block_of(start), end_block = block_of(end);
            const bool one_axis =
                ((end_block - start_block).array() != 0).count() <= 1; // then the way is the same, too
            if (one_axis && start_block == first && end_block == last) continue;
            first = start_block;
            last = end_block;
            walk(start, end, [&](const BlockCoord& block) { keys.add(block_key(block)); });
        }
    }
    return keys.sorted();
}

} // namespace quoin
