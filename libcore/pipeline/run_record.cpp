#include "pipeline/run_record.h"

#include "base/atomic_file.h"

#include <nlohmann/json.hpp>

namespace quoin {

std::optional<RunRecord> parse_run_record(const std::string& text)
{
    try {
        const auto json = nlohmann::json::parse(text);
        RunRecord record;
        record.stage = json.at("stage").get<std::string>();
        record.key = json.value("key", "");
        record.cached = json.value("cached", false);
        record.seconds = json.value("seconds", 0.0);
        record.peak_memory_bytes = json.value("peak_memory_bytes", std::uint64_t{0});
        record.impl_version = json.value("impl_version", 0);
        record.inputs = json.value("inputs", record.inputs);
        record.outputs = json.value("outputs", record.outputs);
        if (json.contains("params")) record.params_json = json["params"].dump();
        return record;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;
    }
}

std::optional<RunRecord> read_run_record(const std::filesystem::path& path)
{
    if (!std::filesystem::is_regular_file(path)) return std::nullopt;
    return parse_run_record(read_text(path));
}

} // namespace quoin
