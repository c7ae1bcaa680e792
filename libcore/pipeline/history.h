// What earlier runs took, and from it what a run will take.
#pragma once

#include "pipeline/description.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

using Sizes = std::map<std::string, std::uint64_t>; // bytes by port

struct PastRun {
    std::string stage;
    int impl_version = 0;
    double seconds = 0.0;
    std::uint64_t peak_memory = 0; // [bytes]
    Sizes inputs, outputs;         // where known
};

struct Estimate {
    std::optional<double> seconds;       // none without a past run
    std::optional<std::uint64_t> memory; // [bytes], from past runs, else by the stage's own formula
    Sizes outputs;                       // [bytes]; without those that are not known
    std::uint64_t disk() const;          // [bytes] of all outputs
};

class History {
public:
    explicit History(std::vector<PastRun> runs);

    // For inputs of these sizes; ports whose size is not known are left out. Time, memory and outputs of the past run
    // whose inputs were nearest in size are scaled by the ratio of the sizes; memory is never scaled down below half,
    // as a part of it is there for any input.
    Estimate estimate(const StageDescription& stage, const Sizes& inputs) const;

private:
    std::multimap<std::string, PastRun> runs_; // by stage
};

} // namespace quoin
