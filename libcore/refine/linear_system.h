#pragma once

#include "refine/refine.h"

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace quoin {

// An entry of a symmetric matrix; both halves are given. Entries at one place add up.
struct MatrixEntry {
    std::uint32_t row = 0, column = 0;
    double value = 0.0;
};

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>; // one row a vertex

// A symmetric positive definite matrix, prepared once for many right-hand sides. The same bytes for any thread count.
class LinearSystem {
public:
    // Throws ImpossibleError if the matrix cannot be factorised.
    LinearSystem(std::size_t size, const std::vector<MatrixEntry>& entries, const OptimizeGeometryParams& params);
    ~LinearSystem();
    LinearSystem(const LinearSystem&) = delete;
    LinearSystem& operator=(const LinearSystem&) = delete;

    // x of A x = b; `guess` is where iterations begin. Throws ImpossibleError if they do not converge.
    Points solve(const Points& b, const Points& guess) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace quoin
