#include "pipeline/task_keys.h"

#include "base/error.h"
#include "store/identity.h"

namespace quoin {

TaskKeys::TaskKeys(const std::vector<Task>& tasks, std::filesystem::path stat_cache)
    : tasks_(tasks), stat_cache_(std::move(stat_cache)), outputs_(tasks.size())
{
}

void TaskKeys::set_outputs(std::size_t task, std::map<std::string, std::string> payloads)
{
    outputs_[task] = std::move(payloads);
}

std::optional<std::string> TaskKeys::payload(std::size_t task, const std::string& port) const
{
    const auto found = outputs_[task].find(port);
    return found == outputs_[task].end() ? std::nullopt : std::optional(found->second);
}

std::optional<InputIdentity> TaskKeys::identity(const TaskInput& input)
{
    if (input.from && tasks_[*input.from].key) {
        const auto known = payload(*input.from, input.from_port);
        if (!known) return std::nullopt;
        return InputIdentity{tasks_[*input.from].key->outputs.at(input.from_port), *known};
    }
    const auto known = on_disk_.find(input.path);
    if (known != on_disk_.end()) return known->second;
    try {
        const InputIdentity found = identify_input({input.port, input.schema}, input.path, stat_cache_);
        if (!input.from) on_disk_.emplace(input.path, found); // what a task makes may change while we run
        return found;
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::optional<Key> TaskKeys::key(std::size_t task)
{
    if (!tasks_[task].key) return std::nullopt;
    KeyParts parts = *tasks_[task].key;
    for (const auto& input : tasks_[task].inputs) {
        auto found = identity(input);
        if (!found) return std::nullopt;
        parts.inputs.emplace(input.port, std::move(*found));
    }
    return make_key(parts);
}

} // namespace quoin
