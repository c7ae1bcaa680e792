#include "refine/linear_system.h"

#include "base/error.h"

#include <Eigen/CholmodSupport>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <fmt/format.h>

namespace quoin {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

Matrix assemble(std::size_t size, const std::vector<MatrixEntry>& entries)
{
    std::vector<Eigen::Triplet<double, int>> triplets;
    triplets.reserve(entries.size());
    for (const auto& e : entries)
        triplets.emplace_back(static_cast<int>(e.row), static_cast<int>(e.column), e.value);
    Matrix matrix(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
}

} // namespace

struct LinearSystem::State {
    Matrix matrix;
    // Simplicial, not supernodal: no BLAS, whose bits depend on the machine.
    std::unique_ptr<Eigen::CholmodSimplicialLDLT<Matrix>> cholesky;
    std::unique_ptr<Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper>> pcg; // Jacobi
};

LinearSystem::LinearSystem(std::size_t size, const std::vector<MatrixEntry>& entries,
                           const OptimizeGeometryParams& params)
    : state_(std::make_unique<State>())
{
    state_->matrix = assemble(size, entries);
    if (params.solver == LinearSolver::Pcg) {
        state_->pcg = std::make_unique<Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper>>(state_->matrix);
        state_->pcg->setTolerance(params.solver_tolerance);
        return;
    }
    state_->cholesky = std::make_unique<Eigen::CholmodSimplicialLDLT<Matrix>>(state_->matrix);
    if (state_->cholesky->info() != Eigen::Success)
        throw ImpossibleError(fmt::format("the geometry system of {} vertices is not positive definite; raise lambda_r "
                                          "or min_face_area, or take solver=pcg",
                                          size));
}

LinearSystem::~LinearSystem() = default;

Points LinearSystem::solve(const Points& b, const Points& guess) const
{
    if (state_->cholesky) return state_->cholesky->solve(b);
    Points x(b.rows(), 3);
    for (int k = 0; k < 3; ++k) {
        x.col(k) = state_->pcg->solveWithGuess(b.col(k), guess.col(k));
        if (state_->pcg->info() != Eigen::Success)
            throw ImpossibleError(
                fmt::format("conjugate gradients stop at a relative residual of {:.1e} after {} iterations; raise "
                            "solver_tolerance or take solver=cholesky",
                            state_->pcg->error(), state_->pcg->iterations()));
    }
    return x;
}

} // namespace quoin
