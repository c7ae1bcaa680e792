// A step of all unknowns in one vector: 6 per frame, 3 per plane, 9 of the colour camera.
#pragma once

#include "alignment/state.h"

namespace quoin {

using StepVector = Eigen::VectorXd;
struct StepLayout {
    std::size_t frames = 0, planes = 0;

    Eigen::Index pose(std::size_t k) const { return static_cast<Eigen::Index>(6 * k); }
    Eigen::Index plane(std::size_t p) const { return static_cast<Eigen::Index>(6 * frames + 3 * p); }
    Eigen::Index calibration() const { return static_cast<Eigen::Index>(6 * frames + 3 * planes); }
    Eigen::Index size() const { return calibration() + 9; }
};
AlignmentState moved(const AlignmentState& state, const StepVector& step);

} // namespace quoin
