#include "quoin/options.h"

#include "base/error.h"
#include "base/log.h"
#include "pipeline/locate.h"
#include "pipeline/pipeline_file.h"
#include "pipeline/study.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <thread>

namespace quoin {
namespace fs = std::filesystem;

void PipelineOptions::add_to(OptionParser& parser)
{
    parser.option("PIPELINE", pipeline, "a pipeline file, or the name of one of Quoin's own").show_default();
    parser.repeated("--config", configs, "a parameter set {stage: {param: value}} laid over the pipeline");
    parser.repeated("-S,--set", settings, "stage.param=value, laid over everything else");
    parser.repeated("--use", uses, "stage=PROGRAM: another program for a stage");
}

void PipelineOptions::add_variant_to(OptionParser& parser)
{
    parser.option("--variant", variant, "one of the pipeline's variants, laid over it");
}

Pipeline PipelineOptions::read(Problems& problems) const
{
    Pipeline text = read_pipeline(find_yaml("pipelines", pipeline), problems);
    for (const auto& config : configs)
        apply_config(text, find_yaml("configs", config), problems);
    for (const auto& setting : settings)
        apply_setting(text, setting, problems);
    for (const auto& use : uses)
        apply_use(text, use, problems);
    return text;
}

Graph PipelineOptions::load() const
{
    Problems problems;
    Pipeline text = read(problems);
    if (!variant.empty()) text = make_variant(text, variant, problems);
    Catalogue catalogue(stage_folder());
    auto graph = check_graph(text, catalogue, problems);
    problems.throw_if_any();
    if (!problems.empty()) fmt::print(stderr, "{}\n", problems.text());
    return *std::move(graph);
}

void PlaceOptions::add_to(OptionParser& parser)
{
    parser.repeated("--scan", scans, "[NAME=]DIR: a scan folder; may be repeated");
    parser.option("--out", out, "where the results appear").show_default();
    parser.option("--store", store, "the content store (default: $QUOIN_STORE, or OUT/.store)");
}

Layout PlaceOptions::layout() const
{
    Layout layout;
    layout.out = fs::absolute(out).lexically_normal();
    if (!layout.out.has_filename()) layout.out = layout.out.parent_path(); // "out/"
    const char* variable = std::getenv("QUOIN_STORE");
    const std::string shared = !store.empty() ? store : variable ? variable : "";
    layout.store = shared.empty() ? layout.out / ".store" : fs::absolute(shared).lexically_normal();
    return layout;
}

std::vector<NamedScan> PlaceOptions::named_scans(const Graph& graph) const
{
    if (!graph.uses_scan() && !scans.empty())
        throw UsageError(fmt::format("--scan {}: pipeline '{}' makes its own scan", scans.front(), graph.name));
    if (!graph.uses_scan()) return {{graph.name, {}}};
    const auto& arguments = scans.empty() ? graph.scans : scans;
    if (arguments.empty()) throw UsageError("no scan: add --scan DIR");
    return parse_scans(arguments);
}

void SelectionOptions::add_to(OptionParser& parser)
{
    parser.option("--from", selection.from, "begin at this stage; results of earlier ones are taken as they are");
    parser.option("--until", selection.until, "end at this stage");
    parser.repeated("--force", selection.force, "compute this stage anew even when the store has its result");
}

void BudgetOptions::add_to(OptionParser& parser)
{
    budget.jobs = 0;
    budget.threads = 0;
    parser.option("--jobs", budget.jobs, "stages side by side (default: 1, or one a scan while each has 4 threads)")
        .positive();
    parser.option("--threads", budget.threads, "threads of all stages together (default: all)").not_negative();
    parser.option("--memory", memory, "memory of all stages together, like 16G; they are told to keep to it");
    parser.option("--timeout", timeout, "time that a stage may take, like 90s, 30m or 2h (default: any)");
    parser.option("--log-level", budget.log_level, "what stages say: debug, info, warning, error or off")
        .show_default();
}

Budget BudgetOptions::complete(std::size_t scans, const Layout& layout) const
{
    constexpr int kThreadsPerScan = 4; // below, stages side by side gain less than they cost in memory
    Budget complete = budget;
    if (complete.threads == 0) complete.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    if (complete.jobs == 0) complete.jobs = std::clamp(complete.threads / kThreadsPerScan, 1, static_cast<int>(scans));
    if (!memory.empty()) complete.memory = parse_bytes(memory, "--memory");
    if (!timeout.empty()) complete.timeout = parse_duration(timeout, "--timeout");
    parse_log_level(complete.log_level);
    complete.store = layout.store;
    return complete;
}

} // namespace quoin
