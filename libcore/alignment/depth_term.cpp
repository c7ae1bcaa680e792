#include "alignment/depth_term.h"

#include "base/lanes.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace quoin {
namespace {

// Calls visit(frame, plane, begin, end) for the samples of every frame on every plane, frames in parallel, and joins
// the results in order.
template <class Result, class Visit>
std::vector<Result> of_all_pairs(const DepthSamples& samples, const Visit& visit)
{
    std::vector<std::vector<Result>> of_frame(samples.first_of_frame.empty() ? 0 : samples.first_of_frame.size() - 1);
    parallel_for(of_frame.size(), [&](std::size_t k) {
        const std::uint32_t last = samples.first_of_frame[k + 1];
        for (std::uint32_t begin = samples.first_of_frame[k], end = begin; begin < last; begin = end) {
            const PlaneId plane = samples.sample[begin].plane;
            while (end < last && samples.sample[end].plane == plane)
                ++end;
            of_frame[k].push_back(visit(static_cast<std::uint32_t>(k), plane, begin, end));
        }
    });
    std::vector<Result> all;
    for (const auto& frame : of_frame)
        all.insert(all.end(), frame.begin(), frame.end());
    return all;
}

// Four samples: measured points, residuals and their inverse sigmas.
struct DepthLanes {
    Doubles x, y, z, inverse_sigma, residual;
};

// Past the end of a run inverse_sigma is zero, and the last point is repeated.
[[gnu::always_inline]] inline DepthLanes load_depths(const DepthSamples& samples, std::uint32_t first,
                                                     std::uint32_t end, const Eigen::Vector4d& residual)
{
    std::array<double, kDoubles> x, y, z, sigma, is_sample;
    for (std::uint32_t i = 0; i < kDoubles; ++i) {
        const DepthSample& sample = samples.sample[std::min(first + i, end - 1)];
        x[i] = sample.p_camera.x();
        y[i] = sample.p_camera.y();
        z[i] = sample.p_camera.z();
        sigma[i] = sample.sigma;
        is_sample[i] = first + i < end ? 1.0 : 0.0;
    }
    DepthLanes lanes{load(x.data()), load(y.data()), load(z.data()), load(is_sample.data()) / load(sigma.data()), {}};
    lanes.residual = residual[0] * lanes.x + residual[1] * lanes.y + residual[2] * lanes.z + residual[3];
    return lanes;
}

Doubles absolute(const Doubles& value) { return value < 0.0 ? -value : value; }

// Moments of the homogeneous points y of a run, weighted by Huber's weight over sigma^2.
struct DepthMoments {
    Eigen::Matrix4d second; // of y y^T
    Eigen::Vector4d first;  // of residual y
};

DepthMoments depth_moments(const DepthSamples& samples, std::uint32_t begin, std::uint32_t end,
                           const Eigen::Vector4d& residual, double huber)
{
    const Doubles one_each = Doubles{} + 1.0;
    Doubles xx{}, xy{}, xz{}, x{}, yy{}, yz{}, y{}, zz{}, z{}, one{}, rx{}, ry{}, rz{}, r{};
    for (std::uint32_t i = begin; i < end; i += kDoubles) {
        const DepthLanes s = load_depths(samples, i, end, residual);
        const Doubles size = absolute(s.residual * s.inverse_sigma);
        const Doubles weight = s.inverse_sigma * s.inverse_sigma * (size > huber ? huber / size : one_each);
        const Doubles wx = weight * s.x, wy = weight * s.y, wz = weight * s.z;
        xx += wx * s.x;
        xy += wx * s.y;
        xz += wx * s.z;
        x += wx;
        yy += wy * s.y;
        yz += wy * s.z;
        y += wy;
        zz += wz * s.z;
        z += wz;
        one += weight;
        rx += wx * s.residual;
        ry += wy * s.residual;
        rz += wz * s.residual;
        r += weight * s.residual;
    }
    DepthMoments moments;
    moments.second << sum(xx), sum(xy), sum(xz), sum(x), sum(xy), sum(yy), sum(yz), sum(y), sum(xz), sum(yz), sum(zz),
        sum(z), sum(x), sum(y), sum(z), sum(one);
    moments.first << sum(rx), sum(ry), sum(rz), sum(r);
    return moments;
}

double depth_cost(const DepthSamples& samples, std::uint32_t begin, std::uint32_t end, const Eigen::Vector4d& residual,
                  double huber)
{
    Doubles cost{};
    for (std::uint32_t i = begin; i < end; i += kDoubles) {
        const DepthLanes s = load_depths(samples, i, end, residual);
        const Doubles size = absolute(s.residual * s.inverse_sigma);
        cost += size <= huber ? size * size : huber * (2.0 * size - huber);
    }
    return sum(cost);
}

Eigen::Vector4d depth_residual(const Rigid& camera_from_world, const CenteredPlane& plane)
{
    const Vector3 n_camera = camera_from_world.linear() * plane.normal;
    return {n_camera.x(), n_camera.y(), n_camera.z(), plane.offset - n_camera.dot(camera_from_world * plane.center)};
}

} // namespace

// With T' = exp(xi) T the point is T^-1 (y - omega x y - v), so dr = (n_c x y) . omega - n_c . v with n_c = R n.
DepthRows depth_rows(const Rigid& camera_from_world, const CenteredPlane& plane, const TangentBasis& tangents)
{
    const Vector3 n_camera = camera_from_world.linear() * plane.normal;
    const Rigid world_from_camera = camera_from_world.inverse();
    const Vector3 camera_center = world_from_camera.translation() - plane.center;
    DepthRows rows;
    rows.derivative.setZero();
    rows.derivative.topLeftCorner<3, 3>() = skew(n_camera);
    rows.derivative.block<3, 1>(3, 3) = -n_camera;
    rows.derivative.block<2, 3>(6, 0) = tangents.transpose() * world_from_camera.linear();
    rows.derivative.block<2, 1>(6, 3) = tangents.transpose() * camera_center;
    rows.derivative(8, 3) = 1.0;
    rows.residual = depth_residual(camera_from_world, plane);
    return rows;
}

std::vector<PairBlock> depth_blocks(const AlignmentState& state, const DepthSamples& samples, double huber)
{
    return of_all_pairs<
        PairBlock>(samples, [&](std::uint32_t k, PlaneId p, std::uint32_t begin, std::uint32_t end) -> PairBlock {
        const DepthRows rows = depth_rows(state.camera_from_world[k], state.plane[p], state.plane[p].tangents());
        const DepthMoments moments = depth_moments(samples, begin, end, rows.residual, huber);
        return {k, p, rows.derivative * moments.second * rows.derivative.transpose(), rows.derivative * moments.first};
    });
}

std::vector<PairCost> depth_costs(const AlignmentState& state, const DepthSamples& samples, double huber)
{
    return of_all_pairs<PairCost>(
        samples, [&](std::uint32_t k, PlaneId p, std::uint32_t begin, std::uint32_t end) -> PairCost {
            const Eigen::Vector4d residual = depth_residual(state.camera_from_world[k], state.plane[p]);
            return {k, p, depth_cost(samples, begin, end, residual, huber)};
        });
}

} // namespace quoin
