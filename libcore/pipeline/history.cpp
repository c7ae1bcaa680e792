#include "pipeline/history.h"

#include "base/error.h"
#include "base/formula.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

std::uint64_t total(const Sizes& sizes)
{
    std::uint64_t sum = 0;
    for (const auto& [port, bytes] : sizes)
        sum += bytes;
    return sum;
}

// Of the ports that both know.
double ratio_of(const Sizes& wanted, const Sizes& past)
{
    double now = 0.0;
    double before = 0.0;
    for (const auto& [port, bytes] : wanted)
        if (const auto it = past.find(port); it != past.end()) {
            now += static_cast<double>(bytes);
            before += static_cast<double>(it->second);
        }
    return now > 0.0 && before > 0.0 ? now / before : 1.0;
}

std::uint64_t scaled(std::uint64_t value, double factor)
{
    return static_cast<std::uint64_t>(std::llround(static_cast<double>(value) * factor));
}

std::optional<std::uint64_t> declared_memory(const StageDescription& stage, const Sizes& inputs)
{
    if (stage.memory_formula.empty()) return std::nullopt;
    const FormulaSource source{.bytes = [&](const std::string& port) -> std::optional<double> {
                                   const auto size = inputs.find(port);
                                   // An optional input that is not wired has no bytes.
                                   const PortDescription* described = find_port(stage.inputs, port);
                                   if (size == inputs.end() && described && described->optional) return 0.0;
                                   return size == inputs.end() ? std::nullopt
                                                               : std::optional(static_cast<double>(size->second));
                               },
                               .value = [](const std::string&) { return std::optional<double>(); }};
    try {
        const auto bytes = evaluate_formula(stage.memory_formula, source);
        return bytes && *bytes > 0.0 ? std::optional(static_cast<std::uint64_t>(*bytes)) : std::nullopt;
    } catch (const UsageError&) {
        return std::nullopt; // a formula of a later version
    }
}

} // namespace

std::uint64_t Estimate::disk() const { return total(outputs); }

History::History(std::vector<PastRun> runs)
{
    for (auto& run : runs) {
        std::string stage = run.stage;
        runs_.emplace(std::move(stage), std::move(run));
    }
}

Estimate History::estimate(const StageDescription& stage, const Sizes& inputs) const
{
    constexpr double kLeastMemoryRatio = 0.5;
    const PastRun* nearest = nullptr;
    double nearest_ratio = 1.0;
    const auto [begin, end] = runs_.equal_range(stage.name);
    for (auto it = begin; it != end; ++it) {
        const PastRun& run = it->second;
        const double ratio = ratio_of(inputs, run.inputs);
        const auto distance = [](double r) { return std::abs(std::log(r)); };
        const bool is_other_version =
            nearest && (run.impl_version == stage.impl_version) != (nearest->impl_version == stage.impl_version);
        const bool is_nearer = is_other_version ? run.impl_version == stage.impl_version
                                                : !nearest || distance(ratio) < distance(nearest_ratio) ||
                                                      (ratio == nearest_ratio && run.seconds > nearest->seconds);
        if (is_nearer) {
            nearest = &run;
            nearest_ratio = ratio;
        }
    }
    Estimate estimate;
    if (!nearest) {
        estimate.memory = declared_memory(stage, inputs);
        return estimate;
    }
    estimate.seconds = nearest->seconds * nearest_ratio;
    estimate.memory = scaled(nearest->peak_memory, std::max(nearest_ratio, kLeastMemoryRatio));
    for (const auto& [port, bytes] : nearest->outputs)
        estimate.outputs[port] = scaled(bytes, nearest_ratio);
    return estimate;
}

} // namespace quoin
