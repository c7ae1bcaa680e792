#include "base/atomic_file.h"
#include "base/error.h"
#include "pipeline/forecast.h"
#include "pipeline/graph_text.h"
#include "pipeline/process.h"
#include "quoin/option_parser.h"
#include "quoin/options.h"

#include <fmt/format.h>
#include <unistd.h>

namespace quoin {
namespace {

std::vector<NodeState> count_states(const Graph& graph, const std::vector<Task>& tasks,
                                    const std::vector<Forecast>& forecasts)
{
    std::vector<NodeState> states(graph.nodes.size());
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        NodeState& state = states[tasks[i].node];
        ++(forecasts[i] == Forecast::Cached    ? state.stored
           : forecasts[i] == Forecast::Compute ? state.compute
                                               : state.follows);
    }
    return states;
}

// Graphviz draws.
std::string as_svg(const std::string& dot, const std::filesystem::path& near)
{
    const auto program = find_program("dot");
    if (!program)
        throw UsageError("--format svg needs Graphviz (the program 'dot'; Debian's package graphviz); --format dot "
                         "writes what it reads");
    const TemporaryPath file(near / "graph.dot");
    write_atomically(file.path(), dot);
    constexpr double kSeconds = 60.0;
    const Captured drawn = capture_all({{*program, {"-Tsvg", file.path().string()}}}, kSeconds).front();
    if (drawn.exit_code != 0 || drawn.timed_out)
        throw UsageError(fmt::format("{} ended with exit code {}", program->string(), drawn.exit_code));
    return drawn.output;
}

} // namespace

int graph_verb(const Arguments& arguments)
{
    OptionParser parser("draws a pipeline; with --scan, coloured by what the store has", "quoin graph");
    PipelineOptions pipeline;
    PlaceOptions place;
    pipeline.add_to(parser);
    pipeline.add_variant_to(parser);
    place.add_to(parser);
    std::string format = "text";
    parser.option("--format", format, "text, dot, mermaid or svg")
        .show_default()
        .one_of({"text", "dot", "mermaid", "svg"});
    if (!parser.parse(arguments)) return 0;
    const Graph graph = pipeline.load();
    std::vector<NodeState> states;
    if (!place.scans.empty()) {
        const Layout layout = place.layout();
        const auto tasks = plan_tasks(graph, place.named_scans(graph), layout, {});
        states = count_states(graph, tasks, forecast_tasks(tasks, layout.store));
    }
    if (format == "text")
        fmt::print("{}", graph_as_text(graph, states, ::isatty(STDOUT_FILENO) != 0));
    else if (format == "mermaid")
        fmt::print("{}", graph_as_mermaid(graph, states));
    else if (format == "dot")
        fmt::print("{}", graph_as_dot(graph, states));
    else
        fmt::print("{}", as_svg(graph_as_dot(graph, states), std::filesystem::temp_directory_path()));
    return 0;
}

} // namespace quoin
