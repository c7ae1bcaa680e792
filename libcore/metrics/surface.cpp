#include "metrics/surface.h"

#include "base/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kSampleGrain = 1024;
constexpr int kRegisterRounds = 20;
constexpr double kLeastReach = 0.02; // at which registration stops trimming harder [m]
constexpr std::size_t kLeastPairs = 100;

struct NormalEquations {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    std::size_t pairs = 0;
};

NormalEquations add(NormalEquations a, const NormalEquations& b)
{
    a.A += b.A;
    a.b += b.b;
    a.pairs += b.pairs;
    return a;
}

} // namespace

Vector3d barycentric(const TriangleMesh& mesh, FaceId face, const Vector3d& point)
{
    const Vector3d a = corner(mesh, face, 0), e1 = corner(mesh, face, 1) - a, e2 = corner(mesh, face, 2) - a,
                   n = e1.cross(e2);
    const double square = n.squaredNorm();
    if (square == 0.0) return Vector3d::UnitX();
    const double b = (point - a).cross(e2).dot(n) / square, c = e1.cross(point - a).dot(n) / square;
    return {1.0 - b - c, b, c};
}

std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, std::size_t count)
{
    std::vector<double> up_to{0.0};
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        up_to.push_back(up_to.back() + face_area(mesh, f));
    if (!(up_to.back() > 0.0)) return {};
    std::vector<SurfaceSample> samples(count);
    parallel_for(
        count,
        [&](std::size_t i) {
            const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * up_to.back();
            const auto above = std::upper_bound(up_to.begin() + 1, up_to.end() - 1, at);
            const auto face = static_cast<FaceId>(above - up_to.begin() - 1);
            const auto part = [](double x) { return x - std::floor(x); };
            const double root = std::sqrt(part(0.5 + 0.7548776662466927 * static_cast<double>(i)));
            const double b = root * (1.0 - part(0.5 + 0.5698402909980532 * static_cast<double>(i)));
            const Vector3d weights(1.0 - root, b, root - b);
            const Vector3d point = weights[0] * corner(mesh, face, 0) + weights[1] * corner(mesh, face, 1) +
                                   weights[2] * corner(mesh, face, 2);
            samples[i] = {point, face_normal(mesh, face), weights, face};
        },
        kSampleGrain);
    return samples;
}

std::vector<double> distances(std::span<const Vector3d> points, const NearestItem& surface, double reach)
{
    std::vector<double> result(points.size(), reach);
    parallel_for(
        points.size(),
        [&](std::size_t i) {
            if (const auto near = surface.find(points[i], reach)) result[i] = near->distance;
        },
        kSampleGrain);
    return result;
}

double median(std::vector<double> values)
{
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

DistanceStatistics statistics(std::vector<double> values)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (values.empty()) return {nan, nan, nan};
    const auto n = static_cast<double>(values.size());
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    const double square = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * (n - 1.0));
    std::nth_element(values.begin(), at, values.end());
    return {sum / n, std::sqrt(square / n), *at};
}

double share_within(std::span<const double> values, double limit)
{
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(std::count_if(values.begin(), values.end(), [&](double d) { return d <= limit; })) /
           static_cast<double>(values.size());
}

TriangleMesh moved(const TriangleMesh& mesh, const Rigid& motion)
{
    TriangleMesh result = mesh;
    for (auto& p : result.position)
        p = (motion * p.cast<double>()).cast<float>();
    for (auto& n : result.normal)
        n = (motion.linear() * n.cast<double>()).cast<float>();
    return result;
}

Rigid register_surface(std::span<const SurfaceSample> model, const TriangleMesh& reference, double reach)
{
    const NearestItem surface(reference);
    Rigid motion = Rigid::Identity();
    for (int round = 0; round < kRegisterRounds; ++round) {
        const auto accumulate = [&](std::size_t begin, std::size_t end) {
            NormalEquations sum;
            for (std::size_t i = begin; i < end; ++i) {
                const Vector3d p = motion * model[i].position;
                const auto near = surface.find(p, reach);
                if (!near) continue;
                const Vector3d normal = face_normal(reference, near->item);
                Twist row;
                row.head<3>() = p.cross(normal);
                row.tail<3>() = normal;
                sum.A += row * row.transpose();
                sum.b -= row * normal.dot(p - near->point);
                ++sum.pairs;
            }
            return sum;
        };
        NormalEquations sum = parallel_reduce(model.size(), kSampleGrain, NormalEquations{}, accumulate, add);
        if (sum.pairs < kLeastPairs) return Rigid::Identity();
        sum.A.diagonal().array() += 1e-9 * sum.A.diagonal().maxCoeff(); // a single plane leaves three directions free
        motion = orthonormalized(exp_twist(sum.A.ldlt().solve(sum.b)) * motion);
        reach = std::max(0.7 * reach, kLeastReach);
    }
    return motion;
}

} // namespace quoin
