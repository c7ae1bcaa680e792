#include "pipeline/rerun.h"

#include "artifact/difference.h"
#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "pipeline/process.h"
#include "store/manifest.h"
#include "store/object.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace fs = std::filesystem;
using Json = nlohmann::json;
namespace {

constexpr double kLongest = 86'400.0; // [s] that one stage may take

// Keys hold floats as text, so that their spelling is one.
std::string value_text(const Json& value)
{
    if (value.is_object()) return value.at("float").get<std::string>();
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string last_line(const std::string& text)
{
    const std::size_t end = text.find_last_not_of('\n');
    if (end == std::string::npos) return {};
    const std::size_t begin = text.rfind('\n', end);
    return text.substr(begin == std::string::npos ? 0 : begin + 1,
                       end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

std::string compare(const fs::path& stored, const fs::path& made)
{
    if (fs::is_directory(stored)) return "the folder's contents differ";
    return first_difference(read_artifact(stored), read_artifact(made)).value_or("the payload of the store is wrong");
}

} // namespace

// How the entry was made.
struct Rerunner::Plan {
    fs::path program;
    std::vector<std::string> arguments;
};

Rerunner::Rerunner(const Store& store, Catalogue& catalogue, const std::vector<fs::path>& scans)
    : store_(store), catalogue_(catalogue)
{
    for (const auto& scan : scans)
        folders_[folder_digest(scan, store.stat_cache())] = scan;
    for (const auto& item : inventory_entries(store)) {
        if (item.is_damaged || !item.entry.outputs.contains("scan")) continue;
        const Json inputs = Json::parse(item.entry.key_json).at("in");
        if (inputs.contains("folder"))
            folder_of_scan_[item.entry.outputs.at("scan")] =
                inputs["folder"].at("payload").get<std::string>().substr(7);
    }
}

// Fills the plan; says why it cannot be made, "" when it can.
std::string Rerunner::make_plan(const InventoryEntry& item, Plan& plan) const
{
    const Json key = Json::parse(item.entry.key_json);
    plan.program = catalogue_.locate(item.stage, {});
    if (!fs::exists(plan.program)) return fmt::format("there is no stage '{}' here", item.stage);
    const StageDescription& stage = catalogue_.describe(plan.program).description;
    if (stage.implementation != key.value("impl", "") || stage.impl_version != key.value("impl_version", 0))
        return fmt::format("made by {} {}; this build has {} {}", key.value("impl", ""), key.value("impl_version", 0),
                           stage.implementation, stage.impl_version);
    const auto folder = [&](const std::string& payload) -> fs::path {
        if (const auto scan = folders_.find(payload); scan != folders_.end()) return scan->second;
        return fs::is_directory(store_.object(payload)) ? store_.object(payload) : fs::path();
    };
    for (const auto& [port, input] : key.at("in").items()) {
        const std::string payload = input.at("payload").get<std::string>().substr(7); // behind "sha256:"
        const fs::path object = store_.object(payload);
        const fs::path path = fs::is_regular_file(object) ? object : folder(payload);
        if (path.empty()) return fmt::format("its input '{}' is not in the store; name its folder with --scan", port);
        plan.arguments.insert(plan.arguments.end(), {"--in", fmt::format("{}={}", port, path.string())});
        const auto root = folder_of_scan_.find(payload);
        if (port != "scan" || !stage.reads_images) continue;
        if (root == folder_of_scan_.end() || folder(root->second).empty())
            return "it reads the scan's images; name their folder with --scan";
        plan.arguments.insert(plan.arguments.end(), {"--scan-root", folder(root->second).string()});
    }
    for (const auto& [name, value] : key.at("params").items())
        plan.arguments.insert(plan.arguments.end(), {"--set", fmt::format("{}={}", name, value_text(value))});
    return {};
}

RerunResult Rerunner::rerun(const InventoryEntry& item, int threads)
{
    Plan plan;
    if (std::string why = make_plan(item, plan); !why.empty()) return {RerunOutcome::Skipped, std::move(why)};
    const TemporaryPath folder(store_.temporary_place("rerun"));
    fs::create_directory(folder.path());
    for (const auto& [port, payload] : item.entry.outputs)
        plan.arguments.insert(plan.arguments.end(),
                              {"--out", fmt::format("{}={}", port, (folder.path() / port).string())});
    plan.arguments.insert(plan.arguments.end(), {"--cache", "off", "--progress", "none", "--threads"});
    plan.arguments.push_back(std::to_string(threads));
    const Captured captured = capture_all({{plan.program, plan.arguments}}, kLongest, Streams::Merged).front();
    if (captured.exit_code != 0 || captured.timed_out)
        return {RerunOutcome::Failed, fmt::format("exit code {}: {}", captured.exit_code, last_line(captured.output))};
    for (const auto& [port, payload] : item.entry.outputs) {
        const fs::path made = folder.path() / port;
        if (object_damage(made, payload).empty()) continue;
        return {RerunOutcome::Differs, fmt::format("output '{}': {}", port, compare(store_.object(payload), made))};
    }
    return {RerunOutcome::Same, {}};
}

} // namespace quoin
