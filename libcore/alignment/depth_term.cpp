#include "alignment/depth_term.h"

#include "base/parallel.h"

namespace quoin {
namespace {

std::vector<PairBlock> frame_blocks(const AlignmentState& state, const DepthSamples& samples, std::uint32_t frame,
                                    double huber)
{
    std::vector<PairBlock> blocks;
    TangentBasis tangents;
    for (std::uint32_t i = samples.first_of_frame[frame]; i < samples.first_of_frame[frame + 1]; ++i) {
        const DepthSample& sample = samples.sample[i];
        const CenteredPlane& plane = state.plane[sample.plane];
        if (blocks.empty() || blocks.back().plane != sample.plane) {
            blocks.emplace_back().frame = frame;
            blocks.back().plane = sample.plane;
            tangents = plane.tangents();
        }
        const DepthRow row = depth_row(state.camera_from_world[frame], plane, tangents, sample.p_camera.cast<double>());
        const double residual = row.residual / sample.sigma;
        const double weight = huber_weight(residual, huber) / (sample.sigma * sample.sigma);
        Eigen::Matrix<double, 9, 1> J;
        J.head<6>() = row.pose;
        J.tail<3>() = row.plane;
        blocks.back().H.noalias() += weight * J * J.transpose();
        blocks.back().g += weight * row.residual * J;
    }
    return blocks;
}

} // namespace

// With T' = exp(xi) T the point is T^-1 (y - omega x y - v), so dr = (n_c x y) . omega - n_c . v with n_c = R n.
DepthRow depth_row(const Rigid& camera_from_world, const CenteredPlane& plane, const TangentBasis& tangents,
                   const Vector3& p_camera)
{
    const Vector3 arm = camera_from_world.inverse() * p_camera - plane.center;
    const Vector3 n_camera = camera_from_world.linear() * plane.normal;
    DepthRow row;
    row.residual = plane.normal.dot(arm) + plane.offset;
    row.pose = twist(n_camera.cross(p_camera), -n_camera);
    row.plane = {tangents.col(0).dot(arm), tangents.col(1).dot(arm), 1.0};
    return row;
}

std::vector<PairBlock> depth_blocks(const AlignmentState& state, const DepthSamples& samples, double huber)
{
    std::vector<std::vector<PairBlock>> of_frame(state.camera_from_world.size());
    parallel_for(of_frame.size(), [&](std::size_t k) {
        of_frame[k] = frame_blocks(state, samples, static_cast<std::uint32_t>(k), huber);
    });
    std::vector<PairBlock> blocks;
    for (const auto& frame : of_frame)
        blocks.insert(blocks.end(), frame.begin(), frame.end());
    return blocks;
}

} // namespace quoin
