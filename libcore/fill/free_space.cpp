#include "fill/free_space.h"

#include "base/parallel.h"
#include "base/progress.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

constexpr std::size_t kBatch = 8;    // depth images in memory at a time
constexpr std::size_t kGrain = 4096; // points of a task

// The nearest measured depth around a pixel, so that the border of something near does not count as far; none when
// nothing was measured there.
double nearest_depth(const DepthImage& depth, int x, int y)
{
    constexpr float kFar = std::numeric_limits<float>::infinity();
    float nearest = kFar;
    for (int v = std::max(0, y - 1); v <= std::min(depth.height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(depth.width - 1, x + 1); ++u)
            if (depth.at(u, v) > 0.0f) nearest = std::min(nearest, depth.at(u, v));
    return nearest < kFar ? nearest : 0.0;
}

bool passes_through(const Eigen::Vector3d& p_camera, const Camera& camera, const DepthImage& depth,
                    const FillHolesParams& params)
{
    if (p_camera.z() <= 0.0) return false;
    const Eigen::Vector2d pixel = camera.project(p_camera);
    if (!camera.contains(pixel, 1.0)) return false;
    constexpr double kDeviations = 3.0;
    const double z = p_camera.z(),
                 tolerance = std::max(params.depth_tolerance, kDeviations * params.depth_noise * z * z);
    return nearest_depth(depth, static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))) >
           z + tolerance;
}

} // namespace

std::vector<std::uint32_t> rays_through(const std::vector<SurfacePoint>& points, const FillHolesInput& input,
                                        const FillHolesParams& params)
{
    std::vector<std::uint32_t> count(points.size(), 0);
    const auto& frames = input.keyframes.frame;
    const Camera& camera = input.images.scan().depth;
    Progress progress("asking for rays", frames.size());
    for (std::size_t begin = 0; begin < frames.size(); begin += kBatch) {
        const std::size_t size = std::min(kBatch, frames.size() - begin);
        std::vector<DepthImage> depth(size);
        parallel_for(size, [&](std::size_t i) {
            depth[i] = input.images.depth(frames[begin + i]);
            progress.step();
        });
        parallel_for(
            points.size(),
            [&](std::size_t p) {
                for (std::size_t i = 0; i < size; ++i)
                    if (!depth[i].empty() &&
                        passes_through(input.alignment.camera_from_world[begin + i] * points[p].p_world, camera,
                                       depth[i], params))
                        ++count[p];
            },
            kGrain);
    }
    return count;
}

} // namespace quoin
