// Notation: X world point, p = T X in the colour camera, u its pixel, I the photograph, g the render's grey, n normal
// at p.
#include "metrics/refine_pose.h"

#include "image/sampling.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kInnerSteps = 5;
constexpr int kCoarsest = 2; // pyramid level of the first round; the next are finer
// Of both images. Bilinear samples between pixels blur the photograph and so lower the residuals of noise and detail:
// without, poses are drawn to where all points fall half-way between pixels.
constexpr double kSmoothing = 1.0;    // [px]
constexpr double kGraySigma = 0.04;   // of 1; Huber's limit of brightness
constexpr double kDepthSigma = 0.004; // at 1 m, grows with the square [m]; Huber's limit of depth
constexpr double kDepthReach = 0.10;  // depth farther off is of something else [m]
constexpr double kJump = 0.03;        // of depth between neighbours, over an edge
constexpr std::size_t kLeastPoints = 200;

struct ModelPoint {
    Vector3d world;
    Vector3d normal_world; // zero over an edge
    float gray;
};

std::vector<ModelPoint> model_points(const RenderedView& view, const Camera& camera, const Rigid& color_from_world)
{
    const GrayImage gray = smooth(to_gray(view.color), kSmoothing);
    const Rigid world_from_color = color_from_world.inverse();
    const auto point = [&](int x, int y) -> Vector3d {
        return camera.ray(Vector2d(x, y)) * static_cast<double>(view.depth.at(x, y));
    };
    std::vector<ModelPoint> points;
    for (int y = 1; y + 1 < camera.height; ++y)
        for (int x = 1; x + 1 < camera.width; ++x) {
            const float z = view.depth.at(x, y);
            if (z <= 0.0f) continue;
            const bool flat = std::abs(view.depth.at(x + 1, y) - z) < kJump * z &&
                              std::abs(view.depth.at(x - 1, y) - z) < kJump * z &&
                              std::abs(view.depth.at(x, y + 1) - z) < kJump * z &&
                              std::abs(view.depth.at(x, y - 1) - z) < kJump * z;
            Vector3d normal = Vector3d::Zero();
            if (flat)
                normal = (point(x + 1, y) - point(x - 1, y)).cross(point(x, y + 1) - point(x, y - 1)).normalized();
            points.push_back({world_from_color * point(x, y), world_from_color.linear() * normal, gray.at(x, y)});
        }
    return points;
}

struct System {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    std::size_t count = 0;

    // Residual r with derivative d r / d p = slope; p moves by omega x p + v.
    void add(const Vector3d& p, const Vector3d& slope, double residual, double sigma)
    {
        Twist row;
        row.head<3>() = p.cross(slope);
        row.tail<3>() = slope;
        const double weight = 1.0 / (sigma * std::max(sigma, std::abs(residual))); // Huber
        A += weight * row * row.transpose();
        b -= weight * residual * row;
        ++count;
    }
};

struct Exposure {
    double gain = 1.0, bias = 0.0;
};

// The photograph at one level, where points fall.
class Level {
public:
    Level(const TargetView& target, const GrayImage& gray, int level)
        : target_(target), gray_(smooth(gray, kSmoothing)), camera_(target.color_camera.at_level(level))
    {
    }
    const Camera& camera() const { return camera_; }

    std::optional<GraySample> see(const Vector3d& p) const
    {
        if (p.z() <= 0.05) return std::nullopt;
        const Vector2d u = camera_.project(p);
        if (!camera_.contains(u, 1.5)) return std::nullopt;
        return sample_gray(gray_, u.x(), u.y());
    }

    // Brightness of the photograph as gain * render + bias.
    Exposure fit_exposure(const std::vector<ModelPoint>& points, const Rigid& T) const
    {
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (const ModelPoint& point : points)
            if (const auto seen = see(T * point.world)) {
                const double g = point.gray, i = seen->value;
                n += 1, x += g, y += i, xx += g * g, xy += g * i;
            }
        const double determinant = n * xx - x * x;
        if (n < 2 || determinant < 1e-6 * n * n) return {};
        const double gain = std::clamp((n * xy - x * y) / determinant, 0.2, 5.0);
        return {gain, (y - gain * x) / n};
    }

    void add_brightness(System& system, const ModelPoint& point, const Vector3d& p, const Exposure& exposure) const
    {
        const auto seen = see(p);
        if (!seen) return;
        const double gx = seen->gx * camera_.fx / p.z(), gy = seen->gy * camera_.fy / p.z();
        const Vector3d slope(gx, gy, -(gx * p.x() + gy * p.y()) / p.z());
        system.add(p, slope, seen->value - exposure.gain * point.gray - exposure.bias, kGraySigma);
    }

    void add_depth(System& system, const ModelPoint& point, const Vector3d& p, const Rigid& T) const
    {
        if (target_.depth.empty() || point.normal_world.isZero()) return;
        const Vector3d q = target_.depth_from_color * p;
        if (q.z() <= 0.05) return;
        const Vector2d u = target_.depth_camera.project(q);
        if (!target_.depth_camera.contains(u, 1.0)) return;
        const int x = static_cast<int>(std::lround(u.x())), y = static_cast<int>(std::lround(u.y()));
        const double z = target_.depth.at(x, y);
        if (z <= 0.0 || std::abs(z - q.z()) > kDepthReach) return;
        const Vector3d measured = target_.depth_from_color.inverse() * (target_.depth_camera.ray(Vector2d(x, y)) * z);
        const Vector3d normal = T.linear() * point.normal_world;
        system.add(p, normal, normal.dot(p - measured), kDepthSigma * std::max(1.0, z * z));
    }

private:
    const TargetView& target_;
    GrayImage gray_;
    Camera camera_;
};

Rigid fit_round(const Level& level, const std::vector<ModelPoint>& points, Rigid T)
{
    for (int step = 0; step < kInnerSteps; ++step) {
        const Exposure exposure = level.fit_exposure(points, T);
        System system;
        for (const ModelPoint& point : points) {
            const Vector3d p = T * point.world;
            level.add_brightness(system, point, p, exposure);
            level.add_depth(system, point, p, T);
        }
        if (system.count < kLeastPoints) return T;
        system.A.diagonal() *= 1.0 + 1e-6;
        T = orthonormalized(exp_twist(system.A.ldlt().solve(system.b)) * T);
    }
    return T;
}

} // namespace

Rigid refine_pose(const TargetView& target, const RenderModel& render, const Rigid& color_from_world, int rounds)
{
    std::vector<GrayImage> pyramid{target.gray};
    for (int l = 0; l < kCoarsest; ++l)
        pyramid.push_back(half_size(pyramid.back()));
    Rigid T = color_from_world;
    for (int round = 0; round < rounds; ++round) {
        const int l = std::max(kCoarsest - round, 0);
        const Level level(target, pyramid[static_cast<std::size_t>(l)], l);
        const RenderedView view = render(level.camera(), T);
        T = fit_round(level, model_points(view, level.camera(), T), T);
    }
    return T.matrix().allFinite() ? T : color_from_world;
}

} // namespace quoin
