#include "quoin/options.h"

#include "base/error.h"
#include "pipeline/locate.h"
#include "pipeline/pipeline_file.h"
#include "quoin/command_line.h"

#include <cstdlib>
#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;

void PipelineOptions::add_to(CLI::App& app)
{
    app.add_option("PIPELINE", pipeline, "a pipeline file, or the name of one of Quoin's own")->capture_default_str();
    add_repeated(app, "--config", configs, "a parameter set {stage: {param: value}} laid over the pipeline");
    add_repeated(app, "-S,--set", settings, "stage.param=value, laid over everything else");
    add_repeated(app, "--use", uses, "stage=PROGRAM: another program for a stage");
}

Graph PipelineOptions::load() const
{
    Problems problems;
    Pipeline pipeline_text = read_pipeline(find_yaml("pipelines", pipeline), problems);
    for (const auto& config : configs)
        apply_config(pipeline_text, find_yaml("configs", config), problems);
    for (const auto& setting : settings)
        apply_setting(pipeline_text, setting, problems);
    for (const auto& use : uses)
        apply_use(pipeline_text, use, problems);
    Catalogue catalogue(stage_folder());
    return build_graph(pipeline_text, catalogue, std::move(problems));
}

void PlaceOptions::add_to(CLI::App& app)
{
    add_repeated(app, "--scan", scans, "[NAME=]DIR: a scan folder; may be repeated");
    app.add_option("--out", out, "where the results appear")->capture_default_str();
    app.add_option("--store", store, "the content store (default: $QUOIN_STORE, or OUT/.store)");
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
    if (scans.empty()) throw UsageError("no scan: add --scan DIR");
    return parse_scans(scans);
}

void SelectionOptions::add_to(CLI::App& app)
{
    app.add_option("--from", selection.from, "begin at this stage; results of earlier ones are taken as they are");
    app.add_option("--until", selection.until, "end at this stage");
    add_repeated(app, "--force", selection.force, "compute this stage anew even when the store has its result");
}

} // namespace quoin
