#pragma once

#include "compare/compare.h"

#include <filesystem>

namespace quoin {

// Compares two folders OUT/<scan> stage by stage: parameters that differ, and every artifact whose payload does.
Comparison compare_runs(const std::filesystem::path& first, const std::filesystem::path& second);

} // namespace quoin
