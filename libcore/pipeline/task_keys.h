// The keys of tasks, computed in the driver by the code that the stages use (store/identity.h): no process is started
// to learn whether the store has a result.
#pragma once

#include "pipeline/plan.h"
#include "store/key.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

class TaskKeys {
public:
    // `stat_cache` as in folder_digest.
    TaskKeys(const std::vector<Task>& tasks, std::filesystem::path stat_cache);

    // None when the program's keys are its own business, or while an input does not exist; it is the stage that says
    // what is wrong with it.
    std::optional<Key> key(std::size_t task);

    // What a task made or the store has of it, by port: the identity of what later tasks read.
    void set_outputs(std::size_t task, std::map<std::string, std::string> payloads);

    std::optional<std::string> payload(std::size_t task, const std::string& port) const;

private:
    std::optional<InputIdentity> identity(const TaskInput& input);

    const std::vector<Task>& tasks_;
    std::filesystem::path stat_cache_;
    std::vector<std::map<std::string, std::string>> outputs_; // one a task; empty = not known
    std::map<std::filesystem::path, InputIdentity> on_disk_;  // a scan's folder is read by several tasks
};

} // namespace quoin
