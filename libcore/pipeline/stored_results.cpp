#include "pipeline/stored_results.h"

#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "base/timer.h"

namespace quoin {
namespace fs = std::filesystem;
namespace {

// The places of all outputs show what the store has of them. The driver itself adds to the model's summary afterwards.
bool link_outputs(const Store& store, const StoreEntry& entry, const Task& task)
{
    for (const auto& output : task.outputs) {
        const auto payload = entry.outputs.find(output.port);
        if (payload == entry.outputs.end() || !store.link(payload->second, output.path, {"summary.json"})) return false;
    }
    return true;
}

void write_record(const fs::path& place, const std::string& record)
{
    fs::create_directories(place.parent_path());
    replace_file(place, record);
}

} // namespace

StoredResults::StoredResults(const std::vector<Task>& tasks, const fs::path& store)
    : tasks_(tasks), store_(store.empty() ? std::nullopt : std::optional<Store>(store)),
      keys_(tasks, store_ ? store_->stat_cache() : fs::path())
{
}

std::optional<TaskResult> StoredResults::take(std::size_t index)
{
    const Task& task = tasks_[index];
    if (!store_ || task.is_forced) return std::nullopt;
    const Timer timer;
    const auto key = keys_.key(index);
    const auto entry = key ? store_->find(*key) : std::nullopt;
    try {
        if (!entry || !link_outputs(*store_, *entry, task)) return std::nullopt;
        const std::string record = served_record(*entry, *key);
        write_record(task.record, record);
        TaskResult result;
        result.state = TaskState::Cached;
        result.record = parse_run_record(record);
        result.seconds = timer.seconds();
        return result;
    } catch (const Error&) {
        return std::nullopt; // the stage meets the same and says it
    } catch (const fs::filesystem_error&) {
        return std::nullopt;
    }
}

std::vector<std::size_t> StoredResults::damaged_inputs(std::size_t task)
{
    std::vector<std::size_t> damaged;
    for (const auto& input : tasks_[task].inputs) {
        if (!store_ || !input.from) continue;
        const auto payload = keys_.payload(*input.from, input.from_port);
        if (!payload) continue;
        // The stage may have found and removed it before us.
        const bool is_gone = tasks_[*input.from].key && !fs::exists(store_->object(*payload));
        if (is_gone || store_->disown_if_damaged(*payload)) damaged.push_back(*input.from);
    }
    return damaged;
}

void StoredResults::add(std::size_t task, const TaskResult& result)
{
    if (result.record) keys_.set_outputs(task, result.record->outputs);
}

} // namespace quoin
