#include "emit/resolved_pipeline.h"

#include "base/param.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); } // JSON's strings are YAML's

std::string use_text(const GraphNode& node, const std::filesystem::path& bin)
{
    if (!node.program.leading.empty()) return quoted(node.program.leading.front());
    return node.program.path.parent_path() == bin ? node.program.path.filename().string()
                                                  : quoted(node.program.path.string());
}

std::string list_text(const std::vector<std::string>& items) { return fmt::format("{}", fmt::join(items, ", ")); }

std::string stage_text(const Graph& graph, const GraphNode& node, const std::filesystem::path& bin)
{
    std::string text = fmt::format("  {}:\n    use: {}\n", node.name, use_text(node, bin));
    std::vector<std::string> code;
    for (std::size_t i = 1; i + 1 < node.program.leading.size(); i += 2) // --code FILE
        code.push_back(quoted(node.program.leading[i + 1]));
    if (!code.empty()) text += fmt::format("    code: [{}]\n", list_text(code));
    std::vector<std::string> wires;
    for (const auto& input : node.inputs)
        wires.push_back(input.from
                            ? fmt::format("{}: {}.{}", input.port, graph.nodes[*input.from].name, input.from_port)
                            : fmt::format("{}: $scan", input.port));
    if (!wires.empty()) text += fmt::format("    in: {{{}}}\n", list_text(wires));
    std::vector<std::string> params;
    for (const auto& param : node.params)
        params.push_back(fmt::format("{}: {}", param.name, quoted(format_param(param.value))));
    return params.empty() ? text : text + fmt::format("    params: {{{}}}\n", list_text(params));
}

} // namespace

std::string resolved_pipeline(const Emission& emission)
{
    std::string text =
        fmt::format("# The pipeline '{}' with all its settings.\nversion: 1\nstages:\n", emission.graph.name);
    for (const auto& node : emission.graph.nodes)
        text += stage_text(emission.graph, node, emission.bin);
    return text;
}

} // namespace quoin
