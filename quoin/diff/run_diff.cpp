#include "quoin/diff/run_diff.h"

#include "pipeline/run_record.h"
#include "pipeline/text_figures.h"

#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Records = std::map<std::string, RunRecord>; // by the folder's name

Records records_in(const fs::path& folder)
{
    Records records;
    for (const auto& entry : fs::directory_iterator(folder))
        if (auto record = read_run_record(entry.path() / "record.json"))
            records.emplace(entry.path().filename().string(), std::move(*record));
    return records;
}

void add_params(const RunRecord& first, const RunRecord& second, Comparison& comparison)
{
    const Json a = Json::parse(first.params_json), b = Json::parse(second.params_json);
    std::set<std::string> names;
    for (const auto* params : {&a, &b})
        for (const auto& [name, value] : params->items())
            names.insert(name);
    for (const auto& name : names) {
        const std::string in_first = a.contains(name) ? a[name].dump() : "-";
        const std::string in_second = b.contains(name) ? b[name].dump() : "-";
        if (in_first != in_second)
            comparison.lines.push_back(fmt::format("  param {}: {} -> {}", name, in_first, in_second));
    }
}

void add_outputs(const fs::path& first, const fs::path& second, const std::pair<RunRecord, RunRecord>& records,
                 Comparison& comparison)
{
    for (const auto& [port, payload] : records.first.outputs) {
        const auto other = records.second.outputs.find(port);
        if (other == records.second.outputs.end() || other->second == payload) continue;
        comparison.is_equal = false;
        const fs::path file = port + ".safetensors";
        if (!fs::exists(first / file) || !fs::exists(second / file)) {
            comparison.lines.push_back(fmt::format("  {}: contents differ", port));
            continue;
        }
        comparison.lines.push_back(fmt::format("  {}:", port));
        for (const auto& line : compare_artifacts(first / file, second / file).lines)
            comparison.lines.push_back("    " + line);
    }
}

std::string title(const std::string& stage, const RunRecord& a, const RunRecord& b)
{
    return fmt::format("{}: {} {}, {} {}; {}", stage, duration_text(a.seconds), bytes_text(a.peak_memory_bytes),
                       duration_text(b.seconds), bytes_text(b.peak_memory_bytes),
                       a.outputs == b.outputs ? "equal" : "differs");
}

} // namespace

Comparison compare_runs(const fs::path& first, const fs::path& second)
{
    Comparison comparison{true, {}};
    const Records a = records_in(first);
    Records b = records_in(second);
    for (const auto& [stage, record] : a) {
        const auto other = b.extract(stage);
        if (other.empty()) {
            comparison.is_equal = false;
            comparison.lines.push_back(fmt::format("{}: only in the first", stage));
            continue;
        }
        comparison.lines.push_back(title(stage, record, other.mapped()));
        add_params(record, other.mapped(), comparison);
        add_outputs(first / stage, second / stage, {record, other.mapped()}, comparison);
    }
    for (const auto& [stage, record] : b) {
        comparison.is_equal = false;
        comparison.lines.push_back(fmt::format("{}: only in the second", stage));
    }
    return comparison;
}

} // namespace quoin
