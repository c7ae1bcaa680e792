// Results that the store has: the driver puts them in their places itself and starts no stage for them.
#pragma once

#include "pipeline/scheduler.h"
#include "pipeline/task_keys.h"
#include "store/store.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace quoin {

class StoredResults {
public:
    // Makes the store when there is none yet; throws Error when that is impossible. `store` empty = no store.
    StoredResults(const std::vector<Task>& tasks, const std::filesystem::path& store);

    // Links the task's outputs and its record into their places. None when it must run, or has to say itself why it
    // cannot.
    std::optional<TaskResult> take(std::size_t task);

    // A task that ran.
    void add(std::size_t task, const TaskResult& result);

    // After a task failed: the tasks whose outputs, as the store holds them, are damaged. Those are taken out of the
    // store; the tasks have to run again.
    std::vector<std::size_t> damaged_inputs(std::size_t task);

private:
    const std::vector<Task>& tasks_;
    std::optional<Store> store_;
    TaskKeys keys_;
};

} // namespace quoin
