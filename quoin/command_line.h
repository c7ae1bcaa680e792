// Command lines of the verbs, on top of CLI11.
#pragma once

#include "quoin/verb.h"

#include <CLI/CLI.hpp>

namespace quoin {

// Parses; prints the help and returns false when it was asked for. Throws UsageError otherwise when something is wrong.
bool parse_arguments(CLI::App& app, const Arguments& arguments);

// An option that may be repeated, with one value each time.
CLI::Option* add_repeated(CLI::App& app, const std::string& flags, std::vector<std::string>& values,
                          const std::string& doc);

} // namespace quoin
