#pragma once

#include "base/log.h"
#include "stage/stage.h"

#include <optional>

namespace quoin {

enum class CacheMode { Auto, Off, Only };
enum class ProgressMode { Auto, Bar, Json, None };

// A stage's command line, checked against its description.
struct CommandLine {
    std::map<std::string, std::filesystem::path> inputs, outputs;
    ParamValues params; // every parameter: default, config file, --set, in rising order
    std::filesystem::path scan_root, store, record;
    int threads = 0;
    std::uint64_t memory = 0; // [bytes]; 0 = no limit
    CacheMode cache = CacheMode::Auto;
    ProgressMode progress = ProgressMode::Auto;
    LogLevel log_level = LogLevel::Info;
    bool help = false, describe = false, key = false;
};

// Throws UsageError saying which argument is wrong and what was expected.
CommandLine parse_command_line(const Stage& stage, const std::vector<ParamSpec>& params, int argc, char** argv);

// "4G", "500M", "1.5G", plain bytes.
std::uint64_t parse_size(std::string_view text);

// name: value pairs of a YAML file, refused with file:line:column when unknown, double or out of range.
ParamValues read_config(const std::filesystem::path& path, const std::vector<ParamSpec>& params);

} // namespace quoin
