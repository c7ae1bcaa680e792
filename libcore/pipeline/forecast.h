// What a run would do, without doing it: no stage is started, the store says what it has.
#pragma once

#include "pipeline/plan.h"

#include <filesystem>
#include <string_view>
#include <vector>

namespace quoin {

enum class Forecast {
    Cached,  // the store has the result
    Compute, // the store lacks it
    Follows, // depends on a result that is computed first; when that comes out as before, it is found in the store
};

// One a task.
std::vector<Forecast> forecast_tasks(const std::vector<Task>& tasks, const std::filesystem::path& store);

std::string_view forecast_text(Forecast forecast); // "in the store", "to compute", "follows"

} // namespace quoin
