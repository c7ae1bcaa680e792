#include "pipeline/forecast.h"

#include "pipeline/task_keys.h"
#include "store/store.h"

#include <algorithm>

namespace quoin {
namespace fs = std::filesystem;

std::vector<Forecast> forecast_tasks(const std::vector<Task>& tasks, const fs::path& root)
{
    std::vector<Forecast> forecasts(tasks.size(), Forecast::Follows);
    std::vector<bool> is_known(tasks.size(), false); // what the task would make
    std::optional<Store> store;                      // without one nothing is known, and a plan makes none
    if (fs::is_directory(root)) store.emplace(root);
    TaskKeys keys(tasks, store ? store->stat_cache() : fs::path());
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        if (!std::ranges::all_of(tasks[i].after, [&](std::size_t before) { return is_known[before]; })) continue;
        const auto key = store ? keys.key(i) : std::nullopt;
        const auto entry = key ? store->find(*key) : std::nullopt;
        forecasts[i] = entry && !tasks[i].is_forced ? Forecast::Cached : Forecast::Compute;
        is_known[i] = entry.has_value();
        if (entry) keys.set_outputs(i, entry->outputs);
    }
    return forecasts;
}

std::string_view forecast_text(Forecast forecast)
{
    constexpr std::string_view texts[] = {"in the store", "to compute", "follows"};
    return texts[static_cast<int>(forecast)];
}

} // namespace quoin
