#include "base/error.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/store_options.h"
#include "store/run_file.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <map>

namespace quoin {
namespace {

namespace fs = std::filesystem;

std::string outcome_text(const RunHistory& run)
{
    if (run.is_running) return fmt::format("running ({})", run.holder);
    if (!run.exit_code) return "was killed";
    return *run.exit_code == 0 ? "done" : fmt::format("exit code {}", *run.exit_code);
}

std::string counts_text(const RunHistory& run)
{
    std::map<std::string, int> counts;
    for (const auto& task : run.tasks)
        ++counts[task.state];
    std::vector<std::string> words;
    for (const auto& [state, count] : counts)
        words.push_back(fmt::format("{} {}", count, state));
    return fmt::format("{}", fmt::join(words, ", "));
}

void print_runs(const std::vector<fs::path>& files, std::size_t count)
{
    for (std::size_t i = files.size() - std::min(count, files.size()); i < files.size(); ++i) {
        const RunHistory run = read_run_file(files[i]);
        fmt::print("{:<22} {}  {:<16} {:>10}  {:<14} {}\n", run.id, run.started, run.pipeline,
                   duration_text(run.seconds), outcome_text(run), counts_text(run));
    }
}

void print_run(const RunHistory& run, const std::string& stage)
{
    fmt::print("{}: {}, {}, {}\n", run.id, run.pipeline, run.started, outcome_text(run));
    for (const auto& task : run.tasks) {
        if (!stage.empty() && task.stage != stage) continue;
        const std::string name = task.variant.empty() ? task.scan : task.scan + "@" + task.variant;
        fmt::print("{:<16} {:<22} {:<9} {:>10} {:>9}  {:.12}\n", name, task.stage, task.state,
                   duration_text(task.seconds), task.peak_memory > 0 ? bytes_text(task.peak_memory) : "", task.key);
        for (const auto& line : task.words)
            fmt::print("    {}\n", line);
    }
}

} // namespace

int log_verb(const Arguments& arguments)
{
    OptionParser parser("shows the runs that used the store, or one of them task by task with what its stages said",
                        "quoin log");
    StoreOptions options;
    std::string run, stage;
    std::size_t count = 20;
    options.add_to(parser);
    parser.option("RUN", run, "a run of the list, or `last`");
    parser.option("STAGE", stage, "only this stage");
    parser.option("--count", count, "runs to list").show_default();
    if (!parser.parse(arguments)) return 0;
    const Store store = options.open();
    const auto files = run_files(store);
    if (run.empty()) {
        print_runs(files, count);
        return 0;
    }
    const auto is_asked = [&](const fs::path& file) { return run == "last" || file.stem().string().starts_with(run); };
    const auto found = std::find_if(files.rbegin(), files.rend(), is_asked);
    if (found == files.rend()) throw UsageError(fmt::format("there is no run '{}'; `quoin log` lists them", run));
    print_run(read_run_file(*found), stage);
    return 0;
}

} // namespace quoin
