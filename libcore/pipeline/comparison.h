// The table of an ablation: every figure of every variant, its mean over the scans and its paired difference to the
// baseline with a 95 % confidence interval (Student's t over the scans).
#pragma once

#include "base/metrics.h"
#include "pipeline/statistics.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

// What one variant gave on one scan; empty when it did not come to its end.
struct Measurement {
    std::string variant;
    std::string scan;
    Metrics metrics;
};

struct ComparedFigure {
    std::size_t scans = 0; // that the variant and the baseline both have a finite value for
    double mean = 0.0;     // over the variant's own scans
    PairedDifference difference;
};

struct ComparedMetric {
    std::string name;
    std::string unit;
    Better better = Better::Neither;
    std::vector<std::optional<ComparedFigure>> figures; // one a variant; none where the variant has no value
};

struct Comparison {
    std::vector<std::string> variants; // the baseline first
    std::vector<std::string> scans;
    std::vector<ComparedMetric> metrics;
};

// Variants and scans in the order in which they come first; the metrics that match `patterns` in the order of these, or
// all.
Comparison compare(const std::vector<Measurement>& measurements, const std::vector<std::string>& patterns);

enum class Verdict { Unclear, Better, Worse }; // Unclear: the interval holds 0, or there is none
Verdict verdict(const ComparedMetric& metric, const ComparedFigure& figure);

std::string comparison_as_text(const Comparison& comparison);
std::string comparison_as_csv(const Comparison& comparison);
std::string comparison_as_latex(const Comparison& comparison);
std::string comparison_as_html(const Comparison& comparison);

// Every single value: metric, unit, variant, scan, value.
std::string measurements_as_csv(const std::vector<Measurement>& measurements);

} // namespace quoin
