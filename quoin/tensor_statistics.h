#pragma once

#include "artifact/artifact.h"

#include <cstddef>
#include <optional>

namespace quoin {

struct TensorStatistics {
    double min = 0.0;
    double max = 0.0;
    double mean = 0.0;          // of the finite values
    std::size_t not_finite = 0; // NaN and infinities
};

// None for a tensor without a finite value.
std::optional<TensorStatistics> statistics_of(const Tensor& tensor);

} // namespace quoin
