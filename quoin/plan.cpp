#include "quoin/plan_table.h"

#include "pipeline/forecast.h"
#include "pipeline/text_figures.h"
#include "quoin/command_line.h"
#include "quoin/options.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {

void print_plan(const std::vector<Task>& tasks, const std::filesystem::path& store)
{
    const auto forecasts = forecast_tasks(tasks, store);
    for (std::size_t i = 0; i < tasks.size(); ++i)
        fmt::print("{:<16} {:<20} {}\n", tasks[i].scan, tasks[i].stage, forecast_text(forecasts[i]));
    const auto count = [&](Forecast forecast) { return std::ranges::count(forecasts, forecast); };
    fmt::print("{} in the store, {} to compute, {} that follow from those\n", count(Forecast::Cached),
               count(Forecast::Compute), count(Forecast::Follows));
}

int plan_verb(const Arguments& arguments)
{
    CLI::App app("shows what `quoin run` would compute and what the store has", "quoin plan");
    PipelineOptions pipeline;
    PlaceOptions place;
    SelectionOptions selection;
    pipeline.add_to(app);
    pipeline.add_variant_to(app);
    place.add_to(app);
    selection.add_to(app);
    if (!parse_arguments(app, arguments)) return 0;
    const Graph graph = pipeline.load();
    const Layout layout = place.layout();
    print_plan(plan_tasks(graph, place.named_scans(graph), layout, selection.selection), layout.store);
    return 0;
}

} // namespace quoin
