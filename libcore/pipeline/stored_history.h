// The history that a store holds: its entries say what every stage took, and how large everything was.
#pragma once

#include "pipeline/forecast.h"
#include "pipeline/history.h"
#include "pipeline/plan.h"

#include <filesystem>
#include <vector>

namespace quoin {

// Of every stage the runs that were used last; empty when there is no store.
History read_history(const std::filesystem::path& store);

// One a task, zero for what the store has: by the sizes of inputs that lie there and by the estimated outputs of tasks
// that make the others.
std::vector<Estimate> estimate_tasks(const std::vector<Task>& tasks, const std::vector<Forecast>& forecasts,
                                     const History& history);

// For one task whose inputs are all there.
Estimate estimate_task(const Task& task, const History& history);

} // namespace quoin
