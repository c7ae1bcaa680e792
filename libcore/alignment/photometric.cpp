#include "alignment/photometric.h"

#include "base/parallel.h"
#include "image/sampling.h"

#include <algorithm>

namespace quoin {
namespace {

constexpr double kMinDepth = 1e-3; // [m]; points nearer to the camera plane have no pixel
constexpr std::size_t kColorGrain = 4096;

GraySample sample_clamped(const FrameSampler& frame, const Vector3& p_color)
{
    if (p_color.z() < kMinDepth) return {0.0f, 0.0f, 0.0f};
    const Eigen::Vector2d u = frame.camera.project(p_color);
    const double x_max = frame.gray.width - 1.001, y_max = frame.gray.height - 1.001;
    const double x = std::clamp(u.x(), 0.0, x_max), y = std::clamp(u.y(), 0.0, y_max);
    GraySample gray = sample_gray(frame.gray, x, y);
    if (x != u.x()) gray.gx = 0.0f;
    if (y != u.y()) gray.gy = 0.0f;
    return gray;
}

// Derivative of the corrected grey by focal length (relative), cx and cy of the full image.
Vector3 by_intrinsics(const FrameSampler& frame, const GraySample& gray, const Vector3& p_color)
{
    const double gx = frame.exposure.gain * gray.gx, gy = frame.exposure.gain * gray.gy;
    const double focal = (gx * frame.camera.fx * p_color.x() + gy * frame.camera.fy * p_color.y()) / p_color.z();
    return {focal, gx * frame.scale, gy * frame.scale};
}

// p - (n . (p - c) + s) n
Eigen::Affine3d projection(const CenteredPlane& plane)
{
    Eigen::Affine3d result;
    result.linear() = Eigen::Matrix3d::Identity() - plane.normal * plane.normal.transpose();
    result.translation() = -plane.signed_distance(Vector3::Zero()) * plane.normal;
    result.makeAffine();
    return result;
}

} // namespace

FrameSampler frame_sampler(const AlignmentScene& scene, const AlignmentState& state, std::size_t frame, int level)
{
    return {scene.images[frame].gray[static_cast<std::size_t>(level)],
            state.color.camera.at_level(level),
            1.0 / (1 << level),
            state.camera_from_world[frame],
            state.color.color_from_depth,
            state.exposure[frame]};
}

// Notation of the derivatives: x the point in the camera, G = dI/dx (a row), m = G in world axes, d = distance of the
// texel's point to its plane. q = p - d n, so dq/d(alpha) = -(n (p-c)^T + d) B and dq/ds = -n.
PhotometricRow photometric_row(const FrameSampler& frame, const CenteredPlane& plane, const TangentBasis& tangents,
                               const Vector3& p_world)
{
    const double d = plane.signed_distance(p_world);
    const Vector3 x_depth = frame.camera_from_world * (p_world - d * plane.normal);
    const Vector3 x = frame.color_from_depth * x_depth;
    const GraySample gray = sample_clamped(frame, x);
    PhotometricRow row;
    row.value = frame.exposure.gain * gray.value + frame.exposure.bias;
    if (x.z() < kMinDepth) return row;

    const double a = frame.exposure.gain * gray.gx * frame.camera.fx / x.z();
    const double b = frame.exposure.gain * gray.gy * frame.camera.fy / x.z();
    const Vector3 G(a, b, -(a * x.x() + b * x.y()) / x.z());
    const Vector3 G_depth = frame.color_from_depth.linear().transpose() * G;
    const Vector3 m = frame.camera_from_world.linear().transpose() * G_depth;
    const double m_n = m.dot(plane.normal);
    row.pose = twist(x_depth.cross(G_depth), G_depth);
    row.plane.head<2>() = -(tangents.transpose() * (m_n * (p_world - plane.center) + d * m));
    row.plane.z() = -m_n;
    row.calibration.head<6>() = twist(x.cross(G), G);
    row.calibration.tail<3>() = by_intrinsics(frame, gray, x);
    return row;
}

std::vector<float> observed_grays(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                  const Observations& observations, int level)
{
    std::vector<float> gray(observations.size());
    parallel_for(scene.frames(), [&](std::size_t k) {
        const FrameSampler frame = frame_sampler(scene, state, k, level);
        const Rigid color_from_world = frame.color_from_depth * frame.camera_from_world;
        PlaneId plane = kNoPlane;
        Eigen::Affine3d color_from_point =
            Eigen::Affine3d::Identity(); // by way of the point's projection onto its plane
        for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
            const TexelId t = observations.texel[o];
            if (texels.plane[t] != plane) {
                plane = texels.plane[t];
                color_from_point = color_from_world * projection(state.plane[plane]);
            }
            gray[o] = sample_clamped(frame, color_from_point * texels.p_world[t].cast<double>()).value;
        }
    });
    return gray;
}

std::vector<float> texel_colors(const Observations& observations, const std::vector<float>& gray, double delta,
                                int rounds)
{
    const std::size_t count = observations.first_of_texel.size() - 1;
    std::vector<float> color(count, 0.0f);
    const auto weighted_mean = [&](std::size_t t, bool robust) {
        double sum = 0.0, weight_sum = 0.0;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const double value = gray[observations.of_texel[i]];
            const double weight = robust ? huber_weight(value - color[t], delta) : 1.0;
            sum += weight * value;
            weight_sum += weight;
        }
        return weight_sum > 0.0 ? static_cast<float>(sum / weight_sum) : 0.0f;
    };
    parallel_for(
        count,
        [&](std::size_t t) {
            for (int round = 0; round <= rounds; ++round)
                color[t] = weighted_mean(t, round > 0);
        },
        kColorGrain);
    return color;
}

} // namespace quoin
