#include "pipeline/summary.h"
#include "quoin/carry_out.h"
#include "quoin/option_parser.h"
#include "quoin/options.h"
#include "quoin/plan_table.h"
#include "quoin/report_sources.h"

#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// Summary and report beside each model; stdout is for results: where the models are.
void print_results(const Graph& graph, const std::vector<NamedScan>& scans, const Layout& layout)
{
    for (const auto& scan : scans) {
        const auto summary = write_summary(graph, scan.name, layout);
        if (summary) write_report(graph, scan, layout, report_page(layout, scan.name));
        const fs::path place = summary ? summary->parent_path() : layout.scan_folder(scan.name);
        fmt::print("{}\n", place.lexically_proximate(fs::current_path()).string());
    }
}

} // namespace

int run_verb(const Arguments& arguments)
{
    OptionParser parser("runs a pipeline on scans; what the store has is not computed again", "quoin run");
    PipelineOptions pipeline;
    PlaceOptions place;
    SelectionOptions selection;
    BudgetOptions budget;
    bool is_dry = false;
    pipeline.add_to(parser);
    pipeline.add_variant_to(parser);
    place.add_to(parser);
    selection.add_to(parser);
    budget.add_to(parser);
    parser.flag("--keep-going", budget.budget.keep_going, "after a failure, go on with what does not depend on it");
    parser.flag("--dry-run", is_dry, "only show what would run");
    if (!parser.parse(arguments)) return 0;
    const Graph graph = pipeline.load();
    const auto scans = place.named_scans(graph);
    const Layout layout = place.layout();
    const auto tasks = plan_tasks(graph, scans, layout, selection.selection);
    if (is_dry) {
        print_plan(tasks, layout.store);
        return 0;
    }
    const RunOutcome outcome = carry_out(tasks, budget.complete(scans.size(), layout), graph.name);
    if (outcome.exit_code == 0) print_results(graph, scans, layout);
    return outcome.exit_code;
}

} // namespace quoin
