#pragma once

#include "pipeline/plan.h"

#include <filesystem>
#include <vector>

namespace quoin {

// Prints for every task whether the store has its result or it would be computed.
void print_plan(const std::vector<Task>& tasks, const std::filesystem::path& store);

} // namespace quoin
