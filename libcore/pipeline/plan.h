// From a graph and scans to tasks: one a stage and scan, with its command line and the tasks that it waits for.
#pragma once

#include "pipeline/graph.h"
#include "pipeline/layout.h"
#include "store/key.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

struct NamedScan {
    std::string name;             // a folder of the output
    std::filesystem::path folder; // absolute
};

// "NAME=DIR" or "DIR" (named after its last folder). Throws UsageError when a folder is missing or a name comes twice.
std::vector<NamedScan> parse_scans(const std::vector<std::string>& arguments);

struct Selection {
    std::string from;               // "" = from the start; results of stages before it are taken as they are
    std::string until;              // "" = to the end
    std::vector<std::string> force; // computed anew even when the store has them
};

struct TaskInput {
    std::string port;
    std::filesystem::path path;
    std::optional<std::size_t>
        from; // the task that makes it; none = the scan folder, or a result that --from relies on
    std::string from_port;
    std::string schema; // that the port takes
};

struct TaskOutput {
    std::string port;
    std::filesystem::path path;
    std::string schema;
};

struct Task {
    std::string scan;
    std::string stage;
    std::size_t node = 0; // in the graph
    std::filesystem::path program;
    std::vector<std::string> leading; // arguments before the stage's own
    std::vector<TaskInput> inputs;
    std::vector<TaskOutput> outputs;
    std::vector<std::string> settings; // "name=value"
    std::filesystem::path scan_root;   // empty unless the stage reads images
    std::filesystem::path record;
    std::shared_ptr<const StageDescription> description; // the tasks of all scans share it
    bool is_forced = false;                              // computed even when the store has it
    std::shared_ptr<const KeyParts> key; // all but the inputs; null when the program's keys are its own business
    std::vector<std::size_t> after;      // indices of tasks; always smaller than its own
};

// The task's command line: ports, parameters, store and record; threads and memory are added when it starts.
std::vector<std::string> arguments_of(const Task& task, const std::filesystem::path& store);

// Tasks scan by scan, in the order of the graph. Throws UsageError for a stage that the graph lacks and InputError for
// a result of an earlier stage that --from relies on and that is not there.
std::vector<Task> plan_tasks(const Graph& graph, const std::vector<NamedScan>& scans, const Layout& layout,
                             const Selection& selection);

// Of tasks that do the same work, as variants share their first stages, all but the first wait for the first: they find
// its result in the store.
void wait_for_equal_tasks(std::vector<Task>& tasks);

} // namespace quoin
