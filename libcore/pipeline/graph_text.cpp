#include "pipeline/graph_text.h"

#include "pipeline/description.h"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace quoin {
namespace {

const std::string& source_name(const Graph& graph, const GraphInput& input)
{
    static const std::string scan = "$scan";
    return input.from ? graph.nodes[*input.from].name : scan;
}

// The schema that flows through the wire.
const std::string& schema_of(const GraphNode& node, const GraphInput& input)
{
    return find_port(node.program.description.inputs, input.port)->schema;
}

std::string used_as(const GraphNode& node)
{
    const std::string& program = node.program.description.name;
    return program == node.name ? node.name : fmt::format("{} ({})", node.name, program);
}

} // namespace

std::string graph_as_text(const Graph& graph)
{
    std::size_t width = 0;
    for (const auto& node : graph.nodes)
        width = std::max(width, used_as(node).size());
    std::string text;
    for (const auto& node : graph.nodes) {
        std::vector<std::string> sources;
        for (const auto& input : node.inputs)
            sources.push_back(input.from ? source_name(graph, input) + "." + input.from_port
                                         : source_name(graph, input));
        const auto outputs = port_names(node.program.description.outputs);
        text +=
            fmt::format("{:<{}}  {} -> {}\n", used_as(node), width, fmt::join(sources, ", "), fmt::join(outputs, ", "));
    }
    return text;
}

std::string graph_as_dot(const Graph& graph)
{
    std::string text = fmt::format("digraph \"{}\" {{\n  rankdir=LR;\n  node [shape=box];\n", graph.name);
    if (graph.uses_scan()) text += "  \"$scan\" [shape=folder];\n";
    for (const auto& node : graph.nodes)
        text += fmt::format("  \"{}\" [label=\"{}\"];\n", node.name, used_as(node));
    for (const auto& node : graph.nodes)
        for (const auto& input : node.inputs)
            text += fmt::format("  \"{}\" -> \"{}\" [label=\"{}\"];\n", source_name(graph, input), node.name,
                                schema_of(node, input));
    return text + "}\n";
}

std::string graph_as_mermaid(const Graph& graph)
{
    const auto id = [&](const std::optional<std::size_t>& node) {
        return node ? fmt::format("s{}", *node) : std::string("scan");
    };
    std::string text = "flowchart LR\n";
    if (graph.uses_scan()) text += "  scan[/scan folder/]\n";
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        text += fmt::format("  {}[\"{}\"]\n", id(i), used_as(graph.nodes[i]));
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        for (const auto& input : graph.nodes[i].inputs)
            text += fmt::format("  {} -- {} --> {}\n", id(input.from), schema_of(graph.nodes[i], input), id(i));
    return text;
}

} // namespace quoin
