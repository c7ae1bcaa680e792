#include "quoin/submission_status.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "emit/submission.h"
#include "pipeline/forecast.h"
#include "pipeline/locate.h"
#include "pipeline/pipeline_file.h"
#include "pipeline/plan.h"
#include "pipeline/process.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

namespace quoin {
namespace {

namespace fs = std::filesystem;

struct Submission {
    std::vector<NamedScan> scans;
    std::vector<std::string> stages; // those that were submitted
    std::vector<Task> tasks;
    std::vector<SubmittedArray> arrays;
    fs::path store;
};

std::vector<NamedScan> read_scans(const fs::path& file)
{
    std::vector<NamedScan> scans;
    std::istringstream lines(read_text(file));
    std::string number, name, folder;
    while (std::getline(lines, number, '\t') && std::getline(lines, name, '\t') && std::getline(lines, folder))
        scans.push_back({name, folder});
    return scans;
}

Submission read_submission(const fs::path& folder)
{
    const auto run = nlohmann::json::parse(read_text(folder / "run.json"), nullptr, false);
    if (!run.is_object() || !run.contains("out") || !run.contains("store") || !run.contains("stages"))
        throw InputError(
            fmt::format("{}: damaged; write the folder anew with `quoin emit slurm`", (folder / "run.json").string()));
    Submission submission;
    submission.scans = read_scans(folder / "scans.tsv");
    submission.store = run["store"].get<std::string>();
    submission.stages = run["stages"].get<std::vector<std::string>>();
    Problems problems;
    const Pipeline pipeline = read_pipeline(folder / "pipeline.yaml", problems);
    Catalogue catalogue(stage_folder());
    const Graph graph = build_graph(pipeline, catalogue, std::move(problems));
    const Layout layout{run["out"].get<std::string>(), submission.store};
    submission.tasks = plan_tasks(graph, submission.scans, layout, {});
    if (fs::exists(folder / "jobs.tsv")) submission.arrays = parse_jobs(read_text(folder / "jobs.tsv"));
    return submission;
}

// What squeue says of the submission's elements; empty without Slurm.
std::vector<QueuedElement> ask_queue(const std::vector<SubmittedArray>& arrays)
{
    constexpr double kSeconds = 20.0;
    const fs::path squeue = find_in_path("squeue");
    if (squeue.empty() || arrays.empty()) return {};
    std::vector<std::string> ids;
    for (const auto& array : arrays)
        ids.push_back(array.job);
    const std::string jobs = fmt::format("{}", fmt::join(ids, ","));
    return parse_queue(
        capture_all({{squeue, {"-h", "-r", "-t", "all", "-o", "%F %K %T", "-j", jobs}}}, kSeconds).front().output);
}

// "97 in the store, 2 running, 1 failed"
std::string counts_text(const std::map<std::string, std::size_t>& counts)
{
    std::vector<std::string> parts;
    for (const auto& [state, count] : counts)
        parts.push_back(fmt::format("{} {}", count, state));
    return fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace

bool is_submission(const fs::path& folder)
{
    return fs::exists(folder / "run.json") && fs::exists(folder / "scans.tsv");
}

void print_submission(const fs::path& folder)
{
    const Submission submission = read_submission(folder);
    const auto forecasts = forecast_tasks(submission.tasks, submission.store);
    const ElementStates states(submission.arrays, ask_queue(submission.arrays));
    std::vector<std::string> failures;
    for (const auto& stage : submission.stages) {
        std::map<std::string, std::size_t> counts;
        for (std::size_t i = 0; i < submission.tasks.size(); ++i) {
            const Task& task = submission.tasks[i];
            if (task.stage != stage) continue;
            const auto scan =
                std::ranges::find(submission.scans, task.scan, &NamedScan::name) - submission.scans.begin();
            const ElementState state = states.of(stage, static_cast<std::size_t>(scan));
            const bool is_done = forecasts[i] == Forecast::Cached;
            ++counts[is_done ? std::string(forecast_text(forecasts[i])) : state.text];
            if (!is_done && state.has_ended)
                failures.push_back(fmt::format("{}: {} {}; see {}", task.scan, stage, state.text,
                                               (folder / "logs" / state.log).string()));
        }
        fmt::print("{:<22} {}\n", stage, counts_text(counts));
    }
    for (const auto& failure : failures)
        fmt::print("{}\n", failure);
}

} // namespace quoin
