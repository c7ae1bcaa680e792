#include "pipeline/summary.h"

#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "pipeline/run_record.h"

#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using Json = nlohmann::ordered_json;

Json stage_figures(const GraphNode& node, const RunRecord& record)
{
    return {{"stage", node.program.description.name},
            {"impl_version", node.program.description.impl_version},
            {"seconds", record.seconds},
            {"peak_memory_bytes", record.peak_memory_bytes},
            {"params", Json::parse(record.params_json)},
            {"key", record.key}};
}

// What the export wrote, or an empty object when it wrote none or something else.
Json read_summary(const std::filesystem::path& path)
{
    if (!std::filesystem::is_regular_file(path)) return Json::object();
    Json summary = Json::parse(read_text(path), nullptr, false);
    return summary.is_object() ? summary : Json::object();
}

} // namespace

std::optional<std::filesystem::path> write_summary(const Graph& graph, const std::string& scan, const Layout& layout)
{
    const std::filesystem::path model = layout.scan_folder(scan) / "model";
    if (!std::filesystem::is_directory(model)) return std::nullopt;
    Json summary = read_summary(model / "summary.json");
    Json stages = Json::object();
    double seconds = 0.0;
    for (const auto& node : graph.nodes) {
        const auto record = read_run_record(layout.record(scan, node.name));
        if (!record) continue;
        stages[node.name] = stage_figures(node, *record);
        seconds += record->seconds;
    }
    summary["scan"] = scan;
    summary["pipeline"] = graph.name;
    summary["seconds"] = seconds;
    summary["stages"] = std::move(stages);
    replace_file(model / "summary.json", summary.dump(2) + "\n");
    return model / "summary.json";
}

} // namespace quoin
