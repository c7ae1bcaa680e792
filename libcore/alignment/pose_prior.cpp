#include "alignment/pose_prior.h"

namespace quoin {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

Matrix6 adjoint_of(const Twist& e) // ad(e), so that [e, x] = ad(e) x for twists (omega, v)
{
    Matrix6 ad = Matrix6::Zero();
    ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = skew(e.head<3>());
    ad.bottomLeftCorner<3, 3>() = skew(e.tail<3>());
    return ad;
}

} // namespace

PosePrior pose_prior(double sigma_rotation_rad, double sigma_translation)
{
    PosePrior prior;
    prior.inverse_sigma =
        twist(Vector3::Constant(1.0 / sigma_rotation_rad), Vector3::Constant(1.0 / sigma_translation));
    return prior;
}

// d log(exp(xi) E) / d xi = J_l^-1(e) = 1 - ad/2 + ad^2/12 - ad^4/720 + ... (Bernoulli series; the next term is of
// order |e|^6).
PoseBlock prior_block(const PosePrior& prior, const Rigid& camera_from_world, const Rigid& input_camera_from_world)
{
    const Twist e = log_twist(camera_from_world * input_camera_from_world.inverse());
    const Matrix6 ad = adjoint_of(e), ad2 = ad * ad;
    const Matrix6 inverse_jacobian = Matrix6::Identity() - 0.5 * ad + ad2 / 12.0 - ad2 * ad2 / 720.0;
    const Matrix6 J = prior.inverse_sigma.asDiagonal() * inverse_jacobian;
    const Twist r = prior.inverse_sigma.cwiseProduct(e);
    return {r.squaredNorm(), J.transpose() * r, J.transpose() * J};
}

} // namespace quoin
