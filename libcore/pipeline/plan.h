// From a graph and scans to tasks: one a stage and scan, with its command line and the tasks that it waits for.
#pragma once

#include "pipeline/graph.h"
#include "pipeline/layout.h"

#include <cstddef>
#include <filesystem>
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

struct Task {
    std::string scan;
    std::string stage;
    std::size_t node = 0; // in the graph
    std::filesystem::path program;
    std::vector<std::string> arguments;          // ports, parameters, store and record; not threads and memory
    std::vector<std::filesystem::path> outputs;
    std::filesystem::path record;
    std::vector<std::size_t> after;              // indices of tasks; always smaller than its own
};

// Tasks scan by scan, in the order of the graph. Throws UsageError for a stage that the graph lacks and InputError for a
// result of an earlier stage that --from relies on and that is not there.
std::vector<Task> plan_tasks(const Graph& graph, const std::vector<NamedScan>& scans, const Layout& layout,
                             const Selection& selection);

} // namespace quoin
