#include "alignment/depth_term.h"

#include "base/lanes.h"
#include "base/parallel.h"

namespace quoin {
namespace {

constexpr std::size_t kDepthGrain = 64;

// Four samples: measured points, residuals and their inverse sigmas; past the end of a run these are zero.
struct DepthLanes {
    Doubles x, y, z, inverse_sigma, residual;
};

[[gnu::always_inline]] inline DepthLanes load_depths(const DepthSamples& samples, std::uint32_t first,
                                                     std::uint32_t end, const Eigen::Vector4d& residual)
{
    const auto part = [&](const std::vector<float>& values) { return load_doubles(&values[first], end - first); };
    DepthLanes lanes{part(samples.x), part(samples.y), part(samples.z), part(samples.inverse_sigma), {}};
    lanes.residual = residual[0] * lanes.x + residual[1] * lanes.y + residual[2] * lanes.z + residual[3];
    return lanes;
}

Doubles absolute(const Doubles& value) { return value < 0.0 ? -value : value; }

// Moments of the homogeneous points y of a run, weighted by Huber's weight over sigma^2.
struct DepthMoments {
    Eigen::Matrix4d second; // of y y^T
    Eigen::Vector4d first;  // of residual y
};

DepthMoments depth_moments(const DepthSamples& samples, const ObservationRun& run, const Eigen::Vector4d& residual,
                           double huber)
{
    const Doubles one_each = Doubles{} + 1.0;
    Doubles xx{}, xy{}, xz{}, x{}, yy{}, yz{}, y{}, zz{}, z{}, one{}, rx{}, ry{}, rz{}, r{};
    for (std::uint32_t i = run.begin; i < run.end; i += kDoubles) {
        const DepthLanes s = load_depths(samples, i, run.end, residual);
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

double depth_cost(const DepthSamples& samples, const ObservationRun& run, const Eigen::Vector4d& residual, double huber)
{
    Doubles cost{};
    for (std::uint32_t i = run.begin; i < run.end; i += kDoubles) {
        const DepthLanes s = load_depths(samples, i, run.end, residual);
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
    std::vector<PairBlock> blocks(samples.run.size());
    const auto visit = [&](std::size_t r) {
        const ObservationRun& run = samples.run[r];
        const CenteredPlane& plane = state.plane[run.plane];
        const DepthRows rows = depth_rows(state.camera_from_world[run.frame], plane, plane.tangents());
        const DepthMoments moments = depth_moments(samples, run, rows.residual, huber);
        blocks[r].frame = run.frame;
        blocks[r].plane = run.plane;
        blocks[r].H.noalias() = rows.derivative * (moments.second * rows.derivative.transpose()).eval();
        blocks[r].g.noalias() = rows.derivative * moments.first;
    };
    parallel_for(blocks.size(), visit, kDepthGrain);
    return blocks;
}

std::vector<PairCost> depth_costs(const AlignmentState& state, const DepthSamples& samples, double huber)
{
    std::vector<PairCost> costs(samples.run.size());
    const auto visit = [&](std::size_t r) {
        const ObservationRun& run = samples.run[r];
        const Eigen::Vector4d residual = depth_residual(state.camera_from_world[run.frame], state.plane[run.plane]);
        costs[r] = {run.frame, run.plane, depth_cost(samples, run, residual, huber)};
    };
    parallel_for(costs.size(), visit, kDepthGrain);
    return costs;
}

} // namespace quoin
