// What a stage wrote down about its run (`STAGE --record FILE`): the figures that depend on the machine and are
// therefore kept out of the artifacts. A run that was found in the store repeats the figures of the run that computed
// it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace quoin {

struct RunRecord {
    std::string stage;
    std::string key;
    bool cached = false;
    double seconds = 0.0;
    std::uint64_t peak_memory_bytes = 0;
    int impl_version = 0;
    std::map<std::string, std::string> inputs;  // port -> payload
    std::map<std::string, std::string> outputs; // port -> payload
    std::string params_json = "{}";
};

// From the JSON of a record; none when it is damaged.
std::optional<RunRecord> parse_run_record(const std::string& json);

// None when the file is missing or damaged: a record never decides whether something runs.
std::optional<RunRecord> read_run_record(const std::filesystem::path& path);

} // namespace quoin
