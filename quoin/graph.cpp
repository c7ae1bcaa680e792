#include "base/error.h"
#include "pipeline/graph_text.h"
#include "quoin/command_line.h"
#include "quoin/options.h"

#include <fmt/format.h>

namespace quoin {

int graph_verb(const Arguments& arguments)
{
    CLI::App app("draws a pipeline", "quoin graph");
    PipelineOptions pipeline;
    pipeline.add_to(app);
    std::string format = "text";
    app.add_option("--format", format, "text, dot or mermaid")
        ->capture_default_str()
        ->check(CLI::IsMember({"text", "dot", "mermaid"}));
    if (!parse_arguments(app, arguments)) return 0;
    const Graph graph = pipeline.load();
    const auto draw = format == "dot" ? graph_as_dot : format == "mermaid" ? graph_as_mermaid : graph_as_text;
    fmt::print("{}", draw(graph));
    return 0;
}

} // namespace quoin
