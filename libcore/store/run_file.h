// What the driver ran, one file a run: what `quoin log` shows, what gc keeps, and, while the run is going on, what gc
// must not touch. Lines of JSON, added as tasks end, so that a run that is killed leaves all but its last words.
#pragma once

#include "store/lease.h"
#include "store/store.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace quoin {

struct RunTask {
    std::string scan, stage, variant;
    std::string state; // "computed", "cached", "failed", "stopped"
    std::string key;
    std::map<std::string, std::string> outputs; // port -> payload
    double seconds = 0.0;
    std::uint64_t peak_memory = 0; // [bytes]
    int exit_code = 0;
    std::vector<std::string> words; // what the stage said
};

struct RunHistory {
    std::string id; // the name of its file: 20261125-013507-1a2b
    std::string pipeline;
    std::string started; // 2026-11-25 01:35:07, UTC
    std::string holder;  // the process that ran it
    bool is_running = false;
    std::vector<RunTask> tasks;
    std::optional<int> exit_code; // none when it runs still, or was killed
    double seconds = 0.0;
};

// Writes one run as it goes on.
class RunFile {
public:
    RunFile(const Store& store, const std::string& pipeline);
    void add(const RunTask& task);
    void end(int exit_code, double seconds);

private:
    HeldFile file_;
};

std::vector<std::filesystem::path> run_files(const Store& store); // oldest first
RunHistory read_run_file(const std::filesystem::path& file);      // lines that are damaged are left out
std::set<std::string> names_in(const RunHistory& run);            // keys and payloads

} // namespace quoin
