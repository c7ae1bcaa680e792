#include "quoin/carry_out.h"

#include "base/timer.h"
#include "pipeline/display.h"
#include "pipeline/run_log.h"
#include "pipeline/stored_history.h"
#include "pipeline/text_figures.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <unistd.h>

namespace quoin {
namespace {

std::ptrdiff_t count(const RunOutcome& outcome, TaskState state)
{
    return std::ranges::count(outcome.results, state, &TaskResult::state);
}

std::string outcome_text(const RunOutcome& outcome, double seconds)
{
    const auto computed = static_cast<std::uint64_t>(count(outcome, TaskState::Computed));
    const auto cached = static_cast<std::uint64_t>(count(outcome, TaskState::Cached));
    const auto failed = static_cast<std::uint64_t>(count(outcome, TaskState::Failed));
    const auto not_run =
        static_cast<std::uint64_t>(count(outcome, TaskState::NotRun) + count(outcome, TaskState::Stopped));
    if (cached == outcome.results.size())
        return fmt::format("nothing to compute: {} in the store", count_text(cached, "stage"));
    std::string text = fmt::format("{} computed in {}", count_text(computed, "stage"), duration_text(seconds));
    if (cached > 0) text += fmt::format(", {} in the store", cached);
    if (failed > 0) text += fmt::format(", {} failed", failed);
    if (not_run > 0) text += fmt::format(", {} not run", not_run);
    return text;
}

// What is given to a task that took as much the last time: scans of one size differ.
std::uint64_t memory_with_margin(const Estimate& estimate)
{
    constexpr std::uint64_t kLeast = 64'000'000; // [bytes]
    const std::uint64_t memory = estimate.memory.value_or(0);
    return memory == 0 ? 0 : memory + std::max(memory / 3, kLeast);
}

} // namespace

RunOutcome carry_out(const std::vector<Task>& tasks, const Budget& budget, const std::string& pipeline)
{
    const Timer timer;
    RunOutcome outcome;
    std::optional<History> history; // is read when the first task has to be computed
    Budget informed = budget;
    informed.memory_need = [&](const Task& task) {
        if (!history) history = read_history(budget.store);
        return memory_with_margin(estimate_task(task, *history));
    };
    {
        Display display(tasks, ::isatty(STDERR_FILENO) != 0);
        RunLog log(tasks, budget.store, pipeline, display);
        outcome = run_tasks(tasks, informed, log);
        log.end(outcome, timer.seconds());
    }
    fmt::print(stderr, "{}\n", outcome_text(outcome, timer.seconds()));
    return outcome;
}

} // namespace quoin
