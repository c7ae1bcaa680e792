#include "alignment/depth_term.h"

#include "base/parallel.h"

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

Eigen::Vector4d homogeneous(const DepthSample& sample) { return sample.p_camera.cast<double>().homogeneous(); }

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
    rows.residual.head<3>() = n_camera;
    rows.residual.w() = plane.normal.dot(camera_center) + plane.offset;
    return rows;
}

std::vector<PairBlock> depth_blocks(const AlignmentState& state, const DepthSamples& samples, double huber)
{
    return of_all_pairs<PairBlock>(
        samples, [&](std::uint32_t k, PlaneId p, std::uint32_t begin, std::uint32_t end) -> PairBlock {
            const DepthRows rows = depth_rows(state.camera_from_world[k], state.plane[p], state.plane[p].tangents());
            Eigen::Matrix4d second = Eigen::Matrix4d::Zero(); // weighted moments of the points
            Eigen::Vector4d first = Eigen::Vector4d::Zero();
            for (std::uint32_t i = begin; i < end; ++i) {
                const double sigma = samples.sample[i].sigma;
                const Eigen::Vector4d y = homogeneous(samples.sample[i]);
                const double residual = rows.residual.dot(y);
                const double weight = huber_weight(residual / sigma, huber) / (sigma * sigma);
                second.noalias() += weight * y * y.transpose();
                first += weight * residual * y;
            }
            return {k, p, rows.derivative * second * rows.derivative.transpose(), rows.derivative * first};
        });
}

std::vector<PairCost> depth_costs(const AlignmentState& state, const DepthSamples& samples, double huber)
{
    return of_all_pairs<PairCost>(
        samples, [&](std::uint32_t k, PlaneId p, std::uint32_t begin, std::uint32_t end) -> PairCost {
            const DepthRows rows = depth_rows(state.camera_from_world[k], state.plane[p], state.plane[p].tangents());
            double cost = 0.0;
            for (std::uint32_t i = begin; i < end; ++i)
                cost += huber_cost(rows.residual.dot(homogeneous(samples.sample[i])) / samples.sample[i].sigma, huber);
            return {k, p, cost};
        });
}

} // namespace quoin
