#include "pipeline/stored_history.h"

#include "pipeline/run_record.h"
#include "store/inventory.h"

#include <algorithm>
#include <map>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kRunsPerStage = 50; // more tell nothing new

PastRun past_run(const InventoryEntry& item, const RunRecord& record, const std::map<std::string, std::uint64_t>& sizes)
{
    PastRun run{item.stage, record.impl_version, record.seconds, record.peak_memory_bytes, {}, item.entry.sizes};
    for (const auto& [port, payload] : record.inputs)
        if (const auto size = sizes.find(payload); size != sizes.end()) run.inputs[port] = size->second;
    return run;
}

std::optional<std::uint64_t> size_of_file(const fs::path& path)
{
    std::error_code error;
    const auto size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
    return size > 0 && !error ? std::optional<std::uint64_t>(size) : std::nullopt;
}

} // namespace

History read_history(const fs::path& root)
{
    if (!fs::is_directory(root)) return History({});
    auto entries = inventory_entries(Store(root));
    std::erase_if(entries, &InventoryEntry::is_damaged);
    std::map<std::string, std::uint64_t> sizes; // by payload
    for (const auto& item : entries)
        for (const auto& [port, payload] : item.entry.outputs)
            if (const auto size = item.entry.sizes.find(port); size != item.entry.sizes.end())
                sizes[payload] = size->second;
    std::ranges::stable_sort(entries, std::greater<>(), &InventoryEntry::used);
    std::map<std::string, std::size_t> taken; // by stage
    std::vector<PastRun> runs;
    for (const auto& item : entries)
        if (const auto record = parse_run_record(item.entry.record_json); record && taken[item.stage]++ < kRunsPerStage)
            runs.push_back(past_run(item, *record, sizes));
    return History(std::move(runs));
}

std::vector<Estimate> estimate_tasks(const std::vector<Task>& tasks, const std::vector<Forecast>& forecasts,
                                     const History& history)
{
    std::vector<Estimate> estimates(tasks.size());
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        if (forecasts[i] == Forecast::Cached) {
            estimates[i] = {0.0, 0, {}};
            continue;
        }
        Sizes inputs;
        for (const auto& input : tasks[i].inputs) {
            const Sizes* made = input.from ? &estimates[*input.from].outputs : nullptr;
            if (const auto size = size_of_file(input.path))
                inputs[input.port] = *size;
            else if (made && made->contains(input.from_port))
                inputs[input.port] = made->at(input.from_port);
        }
        estimates[i] = history.estimate(*tasks[i].description, inputs);
    }
    return estimates;
}

Estimate estimate_task(const Task& task, const History& history)
{
    Sizes inputs;
    for (const auto& input : task.inputs)
        if (const auto size = size_of_file(input.path)) inputs[input.port] = *size;
    return history.estimate(*task.description, inputs);
}

} // namespace quoin
