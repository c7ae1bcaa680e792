#include "base/atomic_file.h"
#include "base/error.h"
#include "pipeline/comparison.h"
#include "pipeline/locate.h"
#include "pipeline/run_record.h"
#include "pipeline/study.h"
#include "quoin/carry_out.h"
#include "quoin/option_parser.h"
#include "quoin/options.h"
#include "quoin/plan_table.h"
#include "schema/schema.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace quoin {
namespace {

namespace fs = std::filesystem;

struct VariantGraph {
    std::string name;
    Graph graph;
};

// Everything that is wrong in any variant is said at once.
std::vector<VariantGraph> check_variants(const Study& study, Problems& problems)
{
    Catalogue catalogue(stage_folder());
    std::vector<VariantGraph> variants;
    for (const auto& [name, pipeline] : study.variants)
        if (auto graph = check_graph(pipeline, catalogue, problems)) variants.push_back({name, std::move(*graph)});
    problems.throw_if_any();
    return variants;
}

// A value that is the baseline's own gives no variant.
void drop_equal_variants(std::vector<VariantGraph>& variants)
{
    std::vector<VariantGraph> kept;
    for (auto& variant : variants) {
        const auto twin = std::ranges::find_if(
            kept, [&](const VariantGraph& other) { return does_the_same(other.graph, variant.graph); });
        if (twin == kept.end())
            kept.push_back(std::move(variant));
        else
            fmt::print(stderr, "{} is the same as {}; left out\n", variant.name, twin->name);
    }
    variants = std::move(kept);
}

Layout layout_of(const Layout& layout, const std::string& variant) { return {layout.out / variant, layout.store}; }

std::vector<Task> plan_variants(const std::vector<VariantGraph>& variants, const std::vector<NamedScan>& scans,
                                const Layout& layout)
{
    std::vector<Task> tasks;
    for (const auto& [name, graph] : variants) {
        const std::size_t first = tasks.size();
        for (auto& task : plan_tasks(graph, scans, layout_of(layout, name), {})) {
            task.scan = name + "/" + task.scan;
            for (auto& input : task.inputs)
                if (input.from) *input.from += first;
            for (auto& before : task.after)
                before += first;
            tasks.push_back(std::move(task));
        }
    }
    wait_for_equal_tasks(tasks);
    return tasks;
}

bool is_measuring(const GraphNode& node)
{
    return std::ranges::all_of(node.program.description.outputs,
                               [](const PortDescription& port) { return port.schema == "metrics"; });
}

// The figures of one variant on one scan: its metrics, and what its stages took when they were computed.
Metrics measure(const Graph& graph, const std::string& scan, const Layout& layout)
{
    Metrics metrics;
    double seconds = 0.0;
    std::uint64_t memory = 0;
    for (const auto& node : graph.nodes) {
        const auto record = read_run_record(layout.record(scan, node.name));
        if (!record) continue;
        if (!is_measuring(node)) {
            seconds += record->seconds;
            memory = std::max(memory, record->peak_memory_bytes);
        }
        for (const auto& port : node.program.description.outputs)
            if (port.schema == "metrics")
                for (auto& metric : read_metrics(layout.output(scan, node.name, port.name, port.schema)))
                    metrics.push_back(std::move(metric));
    }
    constexpr double kMegabyte = 1e6;
    metrics.push_back({"seconds", "s", seconds, Better::Lower});
    metrics.push_back({"peak_memory", "MB", static_cast<double>(memory) / kMegabyte, Better::Lower});
    return metrics;
}

std::vector<Measurement> measure_all(const std::vector<VariantGraph>& variants, const std::vector<NamedScan>& scans,
                                     const Layout& layout, const std::vector<Task>& tasks, const RunOutcome& outcome)
{
    std::map<std::string, bool> is_whole; // by "variant/scan"
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        const TaskState state = outcome.results[i].state;
        const bool is_done = state == TaskState::Computed || state == TaskState::Cached;
        is_whole.emplace(tasks[i].scan, true).first->second &= is_done;
    }
    std::vector<Measurement> measurements;
    for (const auto& [name, graph] : variants)
        for (const auto& scan : scans)
            measurements.push_back(
                {name, scan.name,
                 is_whole.at(name + "/" + scan.name) ? measure(graph, scan.name, layout_of(layout, name)) : Metrics()});
    return measurements;
}

void write_tables(const Comparison& comparison, const std::vector<Measurement>& measurements, const fs::path& out)
{
    write_atomically(out / "ablation.txt", comparison_as_text(comparison));
    write_atomically(out / "ablation.csv", comparison_as_csv(comparison));
    write_atomically(out / "ablation.tex", comparison_as_latex(comparison));
    write_atomically(out / "ablation.html", comparison_as_html(comparison));
    write_atomically(out / "ablation-values.csv", measurements_as_csv(measurements));
    fmt::print(stderr, "tables: {}/ablation.{{txt,csv,tex,html}} and ablation-values.csv\n",
               out.lexically_proximate(fs::current_path()).string());
}

struct AblateOptions {
    PipelineOptions pipeline;
    PlaceOptions place;
    BudgetOptions budget;
    StudyArguments study;
    std::vector<std::string> metrics;
    bool is_dry = false;

    AblateOptions() { pipeline.pipeline = "ablation"; }

    void add_to(OptionParser& parser)
    {
        pipeline.add_to(parser);
        place.add_to(parser);
        budget.add_to(parser);
        parser.repeated("--vary", study.vary, "stage.param=VALUE,VALUE: one variant for each value");
        parser.repeated("--matrix", study.matrix, "the same, repeated: a variant for each combination");
        parser.repeated("--only", study.only, "only this variant, beside the baseline; may be repeated");
        parser.repeated("--metrics", metrics,
                        "figures to show, like 'views.*'; default: those of the pipeline, or all");
        parser.flag("--dry-run", is_dry, "only show what would run");
    }
};

} // namespace

int ablate_verb(const Arguments& arguments)
{
    OptionParser parser("runs variants of a pipeline on the same scans and compares them", "quoin ablate");
    AblateOptions options;
    options.add_to(parser);
    if (!parser.parse(arguments)) return 0;
    Problems problems;
    const Pipeline pipeline = options.pipeline.read(problems);
    const Study study = make_study(pipeline, options.study, problems);
    auto variants = check_variants(study, problems);
    drop_equal_variants(variants);
    const auto scans = options.place.named_scans(variants.front().graph);
    const Layout layout = options.place.layout();
    const auto tasks = plan_variants(variants, scans, layout);
    if (options.is_dry) {
        print_plan(tasks, layout.store);
        return 0;
    }
    Budget budget = options.budget.complete(scans.size() * variants.size(), layout);
    budget.keep_going = true; // a variant that fails leaves a gap in the table
    const RunOutcome outcome = carry_out(tasks, budget, variants.front().graph.name);
    const auto measurements = measure_all(variants, scans, layout, tasks, outcome);
    const auto& patterns = options.metrics.empty() ? study.metrics : options.metrics;
    const Comparison comparison = compare(measurements, patterns);
    write_tables(comparison, measurements, layout.out);
    fmt::print("{}", comparison_as_text(comparison));
    return outcome.exit_code;
}

} // namespace quoin
