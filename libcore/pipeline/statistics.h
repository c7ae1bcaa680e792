// Statistics of paired measurements.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace quoin {

// The t below which a Student-distributed variable stays with `probability` (0.5 to 1, exclusive), at `freedom` >= 1
// degrees of freedom.
double student_quantile(double probability, double freedom);

struct PairedDifference {
    std::size_t pairs = 0;
    double mean = 0.0;                // of changed - base
    std::optional<double> half_width; // of the 95 % confidence interval of the mean; none for less than two pairs
};

// Of measurements of the same things, one behind the other.
PairedDifference paired_difference(const std::vector<double>& base, const std::vector<double>& changed);

} // namespace quoin
