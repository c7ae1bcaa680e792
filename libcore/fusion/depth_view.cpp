#include "fusion/depth_view.h"

#include "image/sampling.h"

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

DepthImage within_range(const DepthImage& depth, const ViewParams& params)
{
    DepthImage kept = depth;
    const auto near = static_cast<float>(params.min_depth), far = static_cast<float>(params.max_depth);
    for (float& z : kept.pixels)
        z = z >= near && z <= far ? z : 0.0f; // NaN is in no range
    return kept;
}

// Does the depth jump between a pixel and one of its four neighbours? Missing neighbours are no jump.
bool at_depth_edge(const DepthImage& depth, int x, int y, float ratio)
{
    const float z = depth.at(x, y), jump = ratio * z;
    const auto jumps = [&](int i, int j) {
        const float other = depth.at(std::clamp(i, 0, depth.width - 1), std::clamp(j, 0, depth.height - 1));
        return other > 0.0f && std::abs(other - z) > jump;
    };
    return jumps(x - 1, y) || jumps(x + 1, y) || jumps(x, y - 1) || jumps(x, y + 1);
}

// Change of depth along a line of pixels [m/px], over a base wide enough for the steps of a quantised sensor.
float slope(const DepthImage& depth, int x, int y, int dx, int dy)
{
    constexpr int kReach = 3; // [px]
    const float z = depth.at(x, y);
    int forward = 0, backward = 0;
    const auto usable = [&](int step) {
        return depth.contains(x + step * dx, y + step * dy) && depth.at(x + step * dx, y + step * dy) > 0.0f;
    };
    while (forward < kReach && usable(forward + 1))
        ++forward;
    while (backward < kReach && usable(-backward - 1))
        ++backward;
    if (forward + backward == 0) return z; // a lone pixel: as steep as can be
    const float ahead = depth.at(x + forward * dx, y + forward * dy),
                behind = depth.at(x - backward * dx, y - backward * dy);
    return (ahead - behind) / static_cast<float>(forward + backward);
}

// Cosine between the ray of a pixel and the normal of the depth surface. With p(u, v) = z(u, v) r(u, v) and the ray
// r = ((u - cx) / fx, (v - cy) / fy, 1), the normal is n ~ (-fx z_u, -fy z_v, z + (u - cx) z_u + (v - cy) z_v), so n .
// r = z.
float incidence(const DepthImage& depth, const Camera& camera, int x, int y)
{
    const float z = depth.at(x, y);
    const float zu = slope(depth, x, y, 1, 0), zv = slope(depth, x, y, 0, 1);
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
    const float du = static_cast<float>(x) - static_cast<float>(camera.cx),
                dv = static_cast<float>(y) - static_cast<float>(camera.cy);
    const float nx = fx * zu, ny = fy * zv, nz = z + du * zu + dv * zv;
    const float normal = std::sqrt(nx * nx + ny * ny + nz * nz);
    const float ray = std::sqrt(1.0f + du * du / (fx * fx) + dv * dv / (fy * fy));
    return z / (normal * ray);
}

// Keeps the pixels that measure a surface, not the air between two, and stores their incidence.
void keep_surface(const DepthImage& depth, const ViewParams& params, DepthView& view)
{
    const Camera& camera = view.camera;
    DepthImage smooth = depth;
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x)
            if (depth.at(x, y) > 0.0f && at_depth_edge(depth, x, y, static_cast<float>(params.depth_edge)))
                smooth.at(x, y) = 0.0f;
    for (int y = 0; y < depth.height; ++y) {
        for (int x = 0; x < depth.width; ++x) {
            if (smooth.at(x, y) <= 0.0f) continue;
            const float cosine = incidence(smooth, camera, x, y);
            if (cosine < static_cast<float>(params.min_incidence)) continue;
            const std::size_t i = index_of(camera, x, y);
            view.depth[i] = smooth.at(x, y);
            view.surface[i].incidence = static_cast<std::uint8_t>(std::max(1.0f, cosine * kIncidenceScale));
        }
    }
}

// Moves depth pixels into the colour camera.
class ColorProjection {
public:
    explicit ColorProjection(const Scan& scan) : depth_(scan.depth), color_(scan.color)
    {
        const Rigid color_from_depth = scan.depth_from_color.inverse();
        rotation_ = color_from_depth.linear().cast<float>();
        translation_ = color_from_depth.translation().cast<float>();
    }
    // (u, v, z) in the colour camera; z <= 0 is behind it.
    Eigen::Vector3f operator()(int x, int y, float z) const
    {
        const Eigen::Vector3f p = rotation_ * (z * depth_.ray({x, y}).cast<float>()) + translation_;
        const float inverse = 1.0f / p.z();
        return {static_cast<float>(color_.fx) * p.x() * inverse + static_cast<float>(color_.cx),
                static_cast<float>(color_.fy) * p.y() * inverse + static_cast<float>(color_.cy), p.z()};
    }

private:
    Camera depth_, color_;
    Eigen::Matrix3f rotation_;
    Eigen::Vector3f translation_;
};

// Nearest depth in cells of the colour image, coarse enough that the depth pixels leave no holes in a surface.
class NearestDepth {
public:
    NearestDepth(const DepthImage& depth, const Camera& color, const ColorProjection& project)
    {
        constexpr double kDepthPixels = 2.0; // across a cell
        cell_ = static_cast<float>(kDepthPixels * std::max(1.0, static_cast<double>(color.width) / depth.width));
        nearest_ = Image<float>(static_cast<int>(static_cast<float>(color.width) / cell_) + 1,
                                static_cast<int>(static_cast<float>(color.height) / cell_) + 1, kFar);
        for (int y = 0; y < depth.height; ++y) {
            for (int x = 0; x < depth.width; ++x) {
                if (depth.at(x, y) <= 0.0f) continue;
                const Eigen::Vector3f q = project(x, y, depth.at(x, y));
                if (!(q.z() > 0.0f && color.contains({q.x(), q.y()}))) continue;
                float& z = at(q);
                z = std::min(z, q.z());
            }
        }
    }
    float of(const Eigen::Vector3f& q) { return at(q); } // of a pixel inside the colour image

private:
    float& at(const Eigen::Vector3f& q)
    {
        return nearest_.at(static_cast<int>(q.x() / cell_), static_cast<int>(q.y() / cell_));
    }
    float cell_ = 1.0f; // [px]
    Image<float> nearest_;
};

std::uint8_t rounded(float value) { return static_cast<std::uint8_t>(value + 0.5f); }

// Gives every kept depth pixel the colour that the colour camera sees at its point, unless something hides the point
// there.
void register_color(const Scan& scan, const DepthImage& depth, const ColorImage& color, const ViewParams& params,
                    DepthView& view)
{
    const ColorProjection project(scan);
    NearestDepth nearest(depth, scan.color, project);
    for (int y = 0; y < depth.height; ++y) {
        for (int x = 0; x < depth.width; ++x) {
            const std::size_t i = index_of(scan.depth, x, y);
            if (view.depth[i] <= 0.0f) continue;
            const Eigen::Vector3f q = project(x, y, view.depth[i]);
            if (!(q.z() > 0.0f && q.x() >= 0.0f && q.y() >= 0.0f)) continue;
            const int u = static_cast<int>(std::min(q.x(), 1e6f)), v = static_cast<int>(std::min(q.y(), 1e6f));
            if (u + 1 >= color.width || v + 1 >= color.height) continue;
            const float tolerance =
                static_cast<float>(params.occlusion) + static_cast<float>(params.depth_edge) * q.z();
            if (q.z() > nearest.of(q) + tolerance) continue;
            const Eigen::Vector3f rgb = sample_color(color, static_cast<double>(q.x()), static_cast<double>(q.y()));
            view.surface[i].color = {rounded(rgb.x()), rounded(rgb.y()), rounded(rgb.z())};
            view.surface[i].incidence |= kHasColor;
        }
    }
    view.has_color = true;
}

Image<float> tile_maxima(const DepthView& view)
{
    const Camera& camera = view.camera;
    Image<float> tiles((camera.width + kTile - 1) / kTile, (camera.height + kTile - 1) / kTile, 0.0f);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            float& largest = tiles.at(x / kTile, y / kTile);
            largest = std::max(largest, view.depth[index_of(camera, x, y)]);
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

} // namespace

DepthView make_view(const Scan& scan, FrameId id, const DepthImage& depth, const ColorImage& color,
                    const ViewParams& params)
{
    DepthView view;
    view.camera = scan.depth;
    view.camera_from_world = scan.frames[id].camera_from_world;
    view.depth.assign(depth.pixels.size() + 1, 0.0f);
    view.surface.assign(depth.pixels.size() + 1, PixelSurface{});
    const DepthImage measured = within_range(depth, params);
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
    std::vector<BlockKey> keys;
    BlockCoord first = BlockCoord::Constant(std::numeric_limits<int>::max()), last = first;
    for (int y = 0; y < camera.height; y += kStride) {
        for (int x = 0; x < camera.width; x += kStride) {
            const float z = view.depth[index_of(camera, x, y)];
            if (z <= 0.0f) continue;
            const Eigen::Vector3f ray = camera.ray({x, y}).cast<float>();
            const float reach = static_cast<float>(truncation) / ray.norm();
            const Eigen::Vector3f direction = blocks_from_camera * ray;
            const Eigen::Vector3f start = eye + direction * (z - reach), end = eye + direction * (z + reach);
            const BlockCoord start_block = block_of(start), end_block = block_of(end);
            const bool one_axis =
                ((end_block - start_block).array() != 0).count() <= 1; // then the way is the same, too
            if (one_axis && start_block == first && end_block == last) continue;
            first = start_block;
            last = end_block;
            walk(start, end, [&](const BlockCoord& block) { keys.push_back(block_key(block)); });
        }
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
}

} // namespace quoin
