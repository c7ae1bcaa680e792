// Named figures: what `evaluate` finds and the report and the ablation table show.
#pragma once

#include <string>
#include <vector>

namespace quoin {

enum class Better { Lower, Higher, Neither };

struct Metric {
    std::string name; // dotted path, "geometry.rms"
    std::string unit; // "m", "dB", "" for a pure number
    double value = 0.0;
    Better better = Better::Neither;
};

using Metrics = std::vector<Metric>; // in the order they are shown; names are unique

} // namespace quoin
