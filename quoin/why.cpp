#include "base/error.h"
#include "pipeline/explain.h"
#include "quoin/option_parser.h"
#include "quoin/options.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

void require_stages(const Graph& graph, const std::vector<std::string>& stages)
{
    std::vector<std::string> names;
    for (const auto& node : graph.nodes)
        names.push_back(node.name);
    for (const auto& stage : stages)
        if (!graph.find(stage))
            throw UsageError(fmt::format("--stage: the pipeline has no stage '{}'{}", stage, hint(stage, names)));
}

} // namespace

int why_verb(const Arguments& arguments)
{
    OptionParser parser(
        "says why stages would run again, down to the parameter or file that changed, or why they would not",
        "quoin why");
    PipelineOptions pipeline;
    PlaceOptions place;
    SelectionOptions selection;
    std::vector<std::string> stages;
    pipeline.add_to(parser);
    pipeline.add_variant_to(parser);
    place.add_to(parser);
    selection.add_to(parser);
    parser.repeated("--stage", stages, "a stage to explain; default: all");
    if (!parser.parse(arguments)) return 0;
    const Graph graph = pipeline.load();
    require_stages(graph, stages);
    const Layout layout = place.layout();
    const auto tasks = plan_tasks(graph, place.named_scans(graph), layout, selection.selection);
    const Explainer explainer(graph, tasks, layout.store);
    for (std::size_t i = 0; i < tasks.size(); ++i)
        if (stages.empty() || std::ranges::find(stages, tasks[i].stage) != stages.end())
            fmt::print("{}", explanation_text(tasks[i], explainer.explain(i)));
    return 0;
}

} // namespace quoin
