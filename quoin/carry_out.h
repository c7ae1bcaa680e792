// A run with its live view and its last line.
#pragma once

#include "pipeline/scheduler.h"

#include <string>
#include <vector>

namespace quoin {

// Runs the tasks, shows them on stderr, writes the store's run file (`quoin log`), and says at the end how many were
// computed, failed and were not run.
RunOutcome carry_out(const std::vector<Task>& tasks, const Budget& budget, const std::string& pipeline);

} // namespace quoin
