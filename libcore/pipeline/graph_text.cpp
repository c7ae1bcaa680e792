#include "pipeline/graph_text.h"

#include "pipeline/description.h"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace quoin {
namespace {

enum class Look { Plain, Stored, Follows, Compute };

struct Style {
    const char* name;   // of the mermaid class
    const char* of_one; // said of a single scan
    const char* words;  // behind the number of scans
    const char* fill;
    const char* terminal;
};

constexpr Style kStyles[] = {
    {"plain", "", "", "#ffffff", ""},
    {"stored", "in the store", "in the store", "#cfe8cf", "\x1b[32m"},
    {"follows", "follows", "follow", "#fff3c4", "\x1b[33m"},
    {"compute", "to compute", "to compute", "#f8cfc4", "\x1b[31m"},
};

const Style& style(Look look) { return kStyles[static_cast<int>(look)]; }

// The least finished of a node's tasks gives its colour.
Look look_of(const std::vector<NodeState>& states, std::size_t node)
{
    if (states.empty()) return Look::Plain;
    const NodeState& state = states[node];
    return state.compute > 0 ? Look::Compute : state.follows > 0 ? Look::Follows : Look::Stored;
}

// "in the store" for one scan, "3 in the store, 1 to compute" for several.
std::string state_text(const std::vector<NodeState>& states, std::size_t node)
{
    if (states.empty()) return {};
    const NodeState& state = states[node];
    if (state.stored + state.compute + state.follows <= 1) return style(look_of(states, node)).of_one;
    std::vector<std::string> parts;
    const auto add = [&](std::size_t count, Look look) {
        if (count > 0) parts.push_back(fmt::format("{} {}", count, style(look).words));
    };
    add(state.stored, Look::Stored);
    add(state.compute, Look::Compute);
    add(state.follows, Look::Follows);
    return fmt::format("{}", fmt::join(parts, ", "));
}

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

std::string graph_as_text(const Graph& graph, const std::vector<NodeState>& states, bool in_color)
{
    std::vector<std::string> wires;
    std::size_t name_width = 0;
    for (const auto& node : graph.nodes) {
        std::vector<std::string> sources;
        for (const auto& input : node.inputs)
            sources.push_back(input.from ? source_name(graph, input) + "." + input.from_port
                                         : source_name(graph, input));
        wires.push_back(fmt::format("{} -> {}", fmt::join(sources, ", "),
                                    fmt::join(port_names(node.program.description.outputs), ", ")));
        name_width = std::max(name_width, used_as(node).size());
    }
    // A state stands in front of the wires, which may be long.
    std::size_t state_width = 0;
    for (std::size_t i = 0; i < states.size(); ++i)
        state_width = std::max(state_width, state_text(states, i).size());
    std::string text;
    for (std::size_t i = 0; i < wires.size(); ++i) {
        std::string state = fmt::format("{:<{}}", state_text(states, i), state_width);
        if (in_color && !states.empty()) state = fmt::format("{}{}\x1b[0m", style(look_of(states, i)).terminal, state);
        text += fmt::format("{:<{}}  {}{}{}\n", used_as(graph.nodes[i]), name_width, state, states.empty() ? "" : "  ",
                            wires[i]);
    }
    return text;
}

std::string graph_as_dot(const Graph& graph, const std::vector<NodeState>& states)
{
    std::string text = fmt::format("digraph \"{}\" {{\n  rankdir=LR;\n  node [shape=box, style=\"rounded,filled\", "
                                   "fillcolor=\"#ffffff\", fontname=\"sans-serif\"];\n"
                                   "  edge [fontname=\"sans-serif\", fontsize=10, color=\"#777777\"];\n",
                                   graph.name);
    if (graph.uses_scan()) text += "  \"$scan\" [shape=folder, style=filled];\n";
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const std::string state = state_text(states, i);
        text +=
            fmt::format("  \"{}\" [label=\"{}{}\", fillcolor=\"{}\"];\n", graph.nodes[i].name, used_as(graph.nodes[i]),
                        state.empty() ? "" : "\\n" + state, style(look_of(states, i)).fill);
    }
    for (const auto& node : graph.nodes)
        for (const auto& input : node.inputs)
            text += fmt::format("  \"{}\" -> \"{}\" [label=\"{}\"];\n", source_name(graph, input), node.name,
                                schema_of(node, input));
    return text + "}\n";
}

std::string graph_as_mermaid(const Graph& graph, const std::vector<NodeState>& states)
{
    const auto id = [&](const std::optional<std::size_t>& node) {
        return node ? fmt::format("s{}", *node) : std::string("scan");
    };
    std::string text = "flowchart LR\n";
    if (graph.uses_scan()) text += "  scan[/scan folder/]\n";
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const std::string state = state_text(states, i);
        text += fmt::format("  {}[\"{}{}\"]{}\n", id(i), used_as(graph.nodes[i]), state.empty() ? "" : "<br>" + state,
                            states.empty() ? "" : std::string(":::") + style(look_of(states, i)).name);
    }
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        for (const auto& input : graph.nodes[i].inputs)
            text += fmt::format("  {} -- {} --> {}\n", id(input.from), schema_of(graph.nodes[i], input), id(i));
    if (!states.empty())
        for (const Look look : {Look::Stored, Look::Follows, Look::Compute})
            text += fmt::format("  classDef {} fill:{}\n", style(look).name, style(look).fill);
    return text;
}

} // namespace quoin
