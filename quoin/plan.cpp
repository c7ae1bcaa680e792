#include "quoin/plan_table.h"

#include "pipeline/forecast.h"
#include "pipeline/stored_history.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/options.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace quoin {
namespace {

constexpr std::size_t kMostRows = 60; // of tasks; more are shown stage by stage

// Of one task, or of all that one stage has to do.
struct Row {
    std::string scan, stage;
    std::size_t stored = 0, compute = 0, follows = 0;
    double seconds = 0.0;
    std::uint64_t memory = 0, disk = 0; // [bytes]; the largest memory
    std::size_t unknown = 0;            // tasks that no earlier run tells the time of

    void add(Forecast forecast, const Estimate& estimate)
    {
        ++(forecast == Forecast::Cached ? stored : forecast == Forecast::Compute ? compute : follows);
        if (forecast == Forecast::Cached) return;
        seconds += estimate.seconds.value_or(0.0);
        unknown += estimate.seconds ? 0 : 1;
        memory = std::max(memory, estimate.memory.value_or(0));
        disk += estimate.disk();
    }
};

std::vector<Row> rows_of(const std::vector<Task>& tasks, const std::vector<Forecast>& forecasts,
                         const std::vector<Estimate>& estimates)
{
    std::vector<Row> rows;
    const bool is_by_stage = tasks.size() > kMostRows;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        auto row = rows.end();
        if (is_by_stage) row = std::ranges::find(rows, tasks[i].stage, &Row::stage);
        if (row == rows.end()) row = rows.insert(rows.end(), Row{is_by_stage ? "" : tasks[i].scan, tasks[i].stage});
        row->add(forecasts[i], estimates[i]);
    }
    return rows;
}

std::string state_text(const Row& row)
{
    if (row.stored + row.compute + row.follows > 1)
        return fmt::format("{} stored, {} to compute, {} follow", row.stored, row.compute, row.follows);
    return std::string(forecast_text(row.stored > 0    ? Forecast::Cached
                                     : row.compute > 0 ? Forecast::Compute
                                                       : Forecast::Follows));
}

// "?" where nothing is known, "" where there is nothing to do.
void print_row(const Row& row)
{
    const std::size_t work = row.compute + row.follows;
    const auto shown = [&](bool is_known, const std::string& text) {
        return work == 0 ? std::string() : is_known ? text : std::string("?");
    };
    fmt::print("{:<16} {:<22} {:<14} {:>10} {:>9} {:>9}\n", row.scan, row.stage, state_text(row),
               shown(row.unknown < work, duration_text(row.seconds)), shown(row.memory > 0, bytes_text(row.memory)),
               shown(row.disk > 0, bytes_text(row.disk)));
}

} // namespace

void print_plan(const std::vector<Task>& tasks, const std::filesystem::path& store)
{
    const auto forecasts = forecast_tasks(tasks, store);
    const auto rows = rows_of(tasks, forecasts, estimate_tasks(tasks, forecasts, read_history(store)));
    fmt::print("{:<16} {:<22} {:<14} {:>10} {:>9} {:>9}\n", "scan", "stage", "", "time", "memory", "disk");
    Row total;
    for (const auto& row : rows) {
        print_row(row);
        total.seconds += row.seconds;
        total.memory = std::max(total.memory, row.memory);
        total.disk += row.disk;
        total.unknown += row.unknown;
    }
    const auto count = [&](Forecast forecast) { return std::ranges::count(forecasts, forecast); };
    fmt::print("{} in the store, {} to compute, {} that follow from those\n", count(Forecast::Cached),
               count(Forecast::Compute), count(Forecast::Follows));
    if (total.seconds > 0.0)
        fmt::print("about {} of work, at most {} at once, {} of results, by earlier runs{}\n",
                   duration_text(total.seconds), bytes_text(total.memory), bytes_text(total.disk),
                   total.unknown > 0 ? fmt::format("; {} never ran", count_text(total.unknown, "stage")) : "");
}

int plan_verb(const Arguments& arguments)
{
    OptionParser parser("shows what `quoin run` would compute, with time, memory and disk from earlier runs",
                        "quoin plan");
    PipelineOptions pipeline;
    PlaceOptions place;
    SelectionOptions selection;
    pipeline.add_to(parser);
    pipeline.add_variant_to(parser);
    place.add_to(parser);
    selection.add_to(parser);
    if (!parser.parse(arguments)) return 0;
    const Graph graph = pipeline.load();
    const Layout layout = place.layout();
    print_plan(plan_tasks(graph, place.named_scans(graph), layout, selection.selection), layout.store);
    return 0;
}

} // namespace quoin
