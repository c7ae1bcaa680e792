#include "alignment/normal_equations.h"

#include <Eigen/Cholesky>

namespace quoin {
namespace {

// Inverse of a damped diagonal block. A block without information (a plane that nothing holds) gives no step.
template <class Matrix>
Matrix damped_inverse(const Matrix& block, double damping)
{
    constexpr double kMinPivot = 1e-12; // relative; below, the block is singular
    Matrix damped = block;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::LDLT<Matrix> factors(damped);
    const auto pivots = factors.vectorD();
    const bool singular = factors.info() != Eigen::Success || !(pivots.minCoeff() > kMinPivot * pivots.maxCoeff());
    return singular ? Matrix(Matrix::Zero()) : Matrix(factors.solve(Matrix::Identity()));
}

struct Preconditioner {
    StepLayout layout;
    std::vector<Eigen::Matrix<double, 6, 6>> pose;
    std::vector<Eigen::Matrix3d> plane;
    Eigen::Matrix<double, 9, 9> calibration;

    Preconditioner(const NormalEquations& equations, double damping)
        : layout(equations.layout), calibration(damped_inverse(equations.calibration_block, damping))
    {
        for (const auto& block : equations.pose_block)
            pose.push_back(damped_inverse(block, damping));
        for (const auto& block : equations.plane_block)
            plane.push_back(damped_inverse(block, damping));
    }
    StepVector operator()(const StepVector& r) const
    {
        StepVector z(r.size());
        for (std::size_t k = 0; k < pose.size(); ++k)
            z.segment<6>(layout.pose(k)) = pose[k] * r.segment<6>(layout.pose(k));
        for (std::size_t p = 0; p < plane.size(); ++p)
            z.segment<3>(layout.plane(p)) = plane[p] * r.segment<3>(layout.plane(p));
        z.segment<9>(layout.calibration()) = calibration * r.segment<9>(layout.calibration());
        return z;
    }
};

StepVector diagonal(const NormalEquations& equations)
{
    const StepLayout& layout = equations.layout;
    StepVector d(layout.size());
    for (std::size_t k = 0; k < layout.frames; ++k)
        d.segment<6>(layout.pose(k)) = equations.pose_block[k].diagonal();
    for (std::size_t p = 0; p < layout.planes; ++p)
        d.segment<3>(layout.plane(p)) = equations.plane_block[p].diagonal();
    d.segment<9>(layout.calibration()) = equations.calibration_block.diagonal();
    return d;
}

} // namespace

StepVector solve_joint(const NormalEquations& equations, double damping, int max_iterations, double tolerance)
{
    const Preconditioner precondition(equations, damping);
    const StepVector extra = damping * diagonal(equations);
    StepVector x = StepVector::Zero(equations.layout.size());
    StepVector r = -equations.gradient;
    StepVector z = precondition(r), direction = z;
    double r_z = r.dot(z);
    const double stop = tolerance * tolerance * r_z;
    for (int i = 0; i < max_iterations && r_z > stop; ++i) {
        const StepVector product = equations.apply(direction) + extra.cwiseProduct(direction);
        const double curvature = direction.dot(product);
        if (!(curvature > 0.0)) break;
        const double length = r_z / curvature;
        x += length * direction;
        r -= length * product;
        z = precondition(r);
        const double next = r.dot(z);
        direction = z + (next / r_z) * direction;
        r_z = next;
    }
    return x;
}

StepVector solve_blocks(const NormalEquations& equations, double damping)
{
    return Preconditioner(equations, damping)(-equations.gradient);
}

} // namespace quoin
