#include "base/error.h"
#include "base/log.h"
#include "base/timer.h"
#include "pipeline/display.h"
#include "pipeline/scheduler.h"
#include "pipeline/summary.h"
#include "pipeline/text_figures.h"
#include "quoin/command_line.h"
#include "quoin/options.h"
#include "quoin/plan_table.h"

#include <algorithm>
#include <fmt/format.h>
#include <thread>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
    PipelineOptions pipeline;
    PlaceOptions place;
    SelectionOptions selection;
    Budget budget;
    std::string memory;
    bool is_dry = false;

    void add_to(CLI::App& app)
    {
        pipeline.add_to(app);
        place.add_to(app);
        selection.add_to(app);
        budget.jobs = 0;
        budget.threads = 0;
        app.add_option("--jobs", budget.jobs,
                       "stages side by side (default: 1, or one a scan while each has 4 threads)")
            ->check(CLI::PositiveNumber);
        app.add_option("--threads", budget.threads, "threads of all stages together (default: all)")
            ->check(CLI::NonNegativeNumber);
        app.add_option("--memory", memory, "memory of all stages together, like 16G");
        app.add_flag("--keep-going", budget.keep_going, "after a failure, go on with what does not depend on it");
        app.add_flag("--dry-run", is_dry, "only show what would run");
        app.add_option("--log-level", budget.log_level, "what stages say: debug, info, warning, error or off")
            ->capture_default_str();
    }
};

Budget complete(const RunOptions& options, std::size_t scans, const Layout& layout)
{
    constexpr int kThreadsPerScan = 4; // below, stages side by side gain less than they cost in memory
    Budget budget = options.budget;
    if (budget.threads == 0) budget.threads = std::max(1U, std::thread::hardware_concurrency());
    if (budget.jobs == 0) budget.jobs = std::clamp(budget.threads / kThreadsPerScan, 1, static_cast<int>(scans));
    if (!options.memory.empty()) budget.memory = parse_bytes(options.memory, "--memory");
    parse_log_level(budget.log_level);
    budget.store = layout.store;
    return budget;
}

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

// stdout is for results: where the models are.
void print_results(const Graph& graph, const std::vector<NamedScan>& scans, const Layout& layout)
{
    for (const auto& scan : scans) {
        const auto summary = write_summary(graph, scan.name, layout);
        const fs::path place = summary ? summary->parent_path() : layout.scan_folder(scan.name);
        fmt::print("{}\n", place.lexically_proximate(fs::current_path()).string());
    }
}

} // namespace

int run_verb(const Arguments& arguments)
{
    CLI::App app("runs a pipeline on scans; what the store has is not computed again", "quoin run");
    RunOptions options;
    options.add_to(app);
    if (!parse_arguments(app, arguments)) return 0;
    const Graph graph = options.pipeline.load();
    const auto scans = options.place.named_scans(graph);
    const Layout layout = options.place.layout();
    const auto tasks = plan_tasks(graph, scans, layout, options.selection.selection);
    const Budget budget = complete(options, scans.size(), layout);
    if (options.is_dry) {
        print_plan(tasks, layout.store);
        return 0;
    }
    const Timer timer;
    RunOutcome outcome;
    {
        Display display(tasks, ::isatty(STDERR_FILENO) != 0);
        outcome = run_tasks(tasks, budget, display);
    }
    fmt::print(stderr, "{}\n", outcome_text(outcome, timer.seconds()));
    if (outcome.exit_code == 0) print_results(graph, scans, layout);
    return outcome.exit_code;
}

} // namespace quoin
