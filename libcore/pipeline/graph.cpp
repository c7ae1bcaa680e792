#include "pipeline/graph.h"

#include "base/error.h"
#include "pipeline/command_file.h"
#include "pipeline/running_order.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace quoin {
namespace {

// A stage of the pipeline next to the program it uses; nullptr where that was refused.
struct Resolved {
    const PipelineStage* stage;
    const Program* program;
};

// The stages of a pipeline, also by name.
struct Stages {
    std::vector<Resolved> list; // in the order of the file
    std::map<std::string, std::size_t, std::less<>> by_name;

    const Resolved* find(const std::string& name) const
    {
        const auto it = by_name.find(name);
        return it == by_name.end() ? nullptr : &list[it->second];
    }
    std::vector<std::string> names() const
    {
        std::vector<std::string> names;
        for (const auto& resolved : list)
            names.push_back(resolved.stage->name);
        return names;
    }
};

Stages find_programs(const Pipeline& pipeline, Catalogue& catalogue, Problems& problems)
{
    std::vector<std::filesystem::path> paths;
    for (const auto& stage : pipeline.stages)
        paths.push_back(catalogue.locate(stage.use, stage.use_folder));
    catalogue.prepare(paths);
    Stages stages;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const PipelineStage& stage = pipeline.stages[i];
        stages.by_name.emplace(stage.name, i);
        stages.list.push_back({&stage, nullptr});
        if (stage.use.empty()) continue; // was refused on reading
        try {
            if (!names_a_path(stage.use) && !std::filesystem::exists(paths[i]))
                problems.add(stage.use_position,
                             fmt::format("there is no stage '{}'{}", stage.use, hint(stage.use, catalogue.names())));
            else if (is_command_file(paths[i].string()))
                stages.list[i].program = catalogue.describe_command(paths[i], problems);
            else
                stages.list[i].program = &catalogue.describe(paths[i]);
        } catch (const UsageError& error) {
            problems.add(stage.use_position, error.what());
        }
    }
    return stages;
}

// A reader at version N also reads N-1, through a migration.
bool is_readable(const PortDescription& output, const PortDescription& input)
{
    return output.schema == input.schema && (output.version == input.version || output.version + 1 == input.version);
}

std::string schema_text(const PortDescription& port) { return fmt::format("{}/{}", port.schema, port.version); }

void check_schema(const PortDescription& output, const PortDescription& input, const Wire& wire, Problems& problems)
{
    if (is_readable(output, input)) return;
    problems.add(wire.position, fmt::format("'{}.{}' is a {}, but input '{}' takes a {}", wire.stage, wire.port,
                                            schema_text(output), input.name, schema_text(input)));
}

void check_wire(const Stages& stages, const PortDescription& input, const Wire& wire, Problems& problems)
{
    if (wire.stage.empty()) {
        if (input.schema != "folder")
            problems.add(wire.position,
                         fmt::format("$scan is a folder, but input '{}' takes a {}", input.name, schema_text(input)));
        return;
    }
    const Resolved* source = stages.find(wire.stage);
    if (!source) {
        problems.add(wire.position,
                     fmt::format("the pipeline has no stage '{}'{}", wire.stage, hint(wire.stage, stages.names())));
    } else if (source->program) {
        const auto& outputs = source->program->description.outputs;
        if (const PortDescription* output = find_port(outputs, wire.port))
            check_schema(*output, input, wire, problems);
        else
            problems.add(wire.position, fmt::format("stage '{}' has no output '{}'{}", wire.stage, wire.port,
                                                    hint(wire.port, port_names(outputs))));
    }
}

// The files of `code:` enter the key of foreign programs only: Quoin's own have a version.
void check_code(const Resolved& resolved, Problems& problems)
{
    if (resolved.program->leading.empty() && !resolved.stage->code.empty())
        problems.add(resolved.stage->position,
                     fmt::format("stage '{}' has 'code', but uses a stage of Quoin's, which has a version instead",
                                 resolved.stage->name));
    for (const auto& file : resolved.stage->code)
        if (!std::filesystem::is_regular_file(file))
            problems.add(resolved.stage->position, fmt::format("{}: no such file", file.string()));
}

void check_inputs(const Stages& stages, const Resolved& resolved, Problems& problems)
{
    const PipelineStage& stage = *resolved.stage;
    const auto& ports = resolved.program->description.inputs;
    for (const auto& [name, wire] : stage.inputs) {
        if (const PortDescription* port = find_port(ports, name))
            check_wire(stages, *port, wire, problems);
        else
            problems.add(wire.name_position, fmt::format("stage '{}' has no input '{}'{}", stage.name, name,
                                                         hint(name, port_names(ports))));
    }
    for (const auto& port : ports)
        if (!port.optional && !stage.inputs.contains(port.name))
            problems.add(stage.position, fmt::format("input '{}' of stage '{}' is not wired; it takes a {}", port.name,
                                                     stage.name, schema_text(port)));
}

std::vector<GraphParam> check_params(const Resolved& resolved, Problems& problems)
{
    std::vector<std::string> names;
    for (const auto& spec : resolved.program->description.params)
        names.push_back(spec.name);
    std::vector<GraphParam> params;
    for (const auto& [name, setting] : resolved.stage->params) {
        const auto& specs = resolved.program->description.params;
        const auto spec = std::ranges::find(specs, name, &ParamSpec::name);
        if (spec == specs.end()) {
            problems.add(setting.name_position, fmt::format("stage '{}' has no parameter '{}'{}", resolved.stage->name,
                                                            name, hint(name, names)));
            continue;
        }
        const std::string who = fmt::format("stage '{}'", resolved.stage->name);
        try {
            params.push_back({name, parse_param(*spec, setting.text, who), setting.position});
        } catch (const UsageError& error) {
            problems.add(setting.position, error.what());
        }
    }
    return params;
}

// For each stage, the stages whose outputs it reads.
Waits wires_of(const Stages& stages)
{
    Waits waits;
    for (const auto& resolved : stages.list) {
        std::set<std::size_t> sources;
        for (const auto& [port, wire] : resolved.stage->inputs)
            if (const auto source = stages.by_name.find(wire.stage); source != stages.by_name.end())
                sources.insert(source->second);
        waits.emplace_back(sources.begin(), sources.end());
    }
    return waits;
}

void check_circles(const Stages& stages, const Waits& waits, const std::vector<std::size_t>& order, Problems& problems)
{
    if (order.size() == waits.size()) return;
    for (const auto& circle : find_circles(waits, order)) {
        std::vector<std::string> names;
        for (const std::size_t stage : circle)
            names.push_back(stages.list[stage].stage->name);
        problems.add(stages.list[circle.front()].stage->position,
                     fmt::format("stages wait for each other: {}", fmt::join(names, " -> ")));
    }
}

// What a person wants from a pipeline: its last stages need no reader.
bool is_result(const PortDescription& port) { return is_directory_schema(port.schema) || port.schema == "metrics"; }

// An output that nobody reads is work for nothing, where the pipeline has results that it is not one of.
void check_unused_outputs(const Stages& stages, Problems& problems)
{
    std::set<std::pair<std::string, std::string>> read;
    for (const auto& resolved : stages.list)
        for (const auto& [port, wire] : resolved.stage->inputs)
            read.emplace(wire.stage, wire.port);
    std::vector<std::pair<const PipelineStage*, const PortDescription*>> unused;
    bool has_results = false;
    for (const auto& [stage, program] : stages.list) {
        if (!program) continue;
        for (const auto& port : program->description.outputs) {
            has_results = has_results || is_result(port);
            if (!is_result(port) && !read.contains({stage->name, port.name})) unused.emplace_back(stage, &port);
        }
    }
    for (const auto& [stage, port] : unused)
        if (has_results)
            problems.warn(stage->position,
                          fmt::format("output '{}' of stage '{}' is read by no stage", port->name, stage->name));
}

GraphNode make_node(const Resolved& resolved, std::vector<GraphParam> params,
                    const std::map<std::string, std::size_t, std::less<>>& node_of)
{
    GraphNode node{resolved.stage->name, *resolved.program, {}, std::move(params)};
    for (const auto& file : resolved.stage->code) {
        node.program.leading.insert(node.program.leading.end(), {"--code", file.string()});
        node.program.code.push_back(file);
    }
    for (const auto& port : resolved.program->description.inputs) {
        const auto wire = resolved.stage->inputs.find(port.name);
        if (wire == resolved.stage->inputs.end()) continue;
        const auto from = node_of.find(wire->second.stage);
        node.inputs.push_back(
            {port.name, from == node_of.end() ? std::nullopt : std::optional(from->second), wire->second.port});
    }
    return node;
}

} // namespace

std::optional<Graph> check_graph(const Pipeline& pipeline, Catalogue& catalogue, Problems& problems)
{
    const Stages stages = find_programs(pipeline, catalogue, problems);
    std::vector<std::vector<GraphParam>> params(stages.list.size());
    for (std::size_t i = 0; i < stages.list.size(); ++i) {
        if (!stages.list[i].program) continue;
        check_inputs(stages, stages.list[i], problems);
        check_code(stages.list[i], problems);
        params[i] = check_params(stages.list[i], problems);
    }
    const Waits waits = wires_of(stages);
    const auto order = running_order(waits);
    check_circles(stages, waits, order, problems);
    check_unused_outputs(stages, problems);
    if (problems.has_errors()) return std::nullopt;

    Graph graph{pipeline.name, {}, pipeline.scans};
    std::map<std::string, std::size_t, std::less<>> node_of;
    for (const std::size_t i : order) {
        graph.nodes.push_back(make_node(stages.list[i], std::move(params[i]), node_of));
        node_of.emplace(graph.nodes.back().name, node_of.size());
    }
    return graph;
}

Graph build_graph(const Pipeline& pipeline, Catalogue& catalogue, Problems problems)
{
    auto graph = check_graph(pipeline, catalogue, problems);
    problems.throw_if_any();
    return *std::move(graph);
}

std::optional<std::size_t> Graph::find(const std::string& stage) const
{
    const auto node = std::ranges::find(nodes, stage, &GraphNode::name);
    return node == nodes.end() ? std::nullopt : std::optional(static_cast<std::size_t>(node - nodes.begin()));
}

bool Graph::uses_scan() const
{
    return std::ranges::any_of(nodes, [](const GraphNode& node) {
        return std::ranges::any_of(node.inputs, [](const GraphInput& input) { return !input.from; });
    });
}

const GraphInput* Graph::scan_folder(std::size_t node) const
{
    const auto& inputs = nodes[node].inputs;
    const auto& ports = nodes[node].program.description.inputs;
    for (const auto& input : inputs)
        if (find_port(ports, input.port)->schema == "folder") return &input;
    for (const auto& input : inputs)
        if (find_port(ports, input.port)->schema == "scan") return scan_folder(*input.from);
    for (const auto& input : inputs)
        if (const GraphInput* found = scan_folder(*input.from)) return found;
    return nullptr;
}

std::vector<bool> Graph::downstream(std::size_t node) const
{
    std::vector<bool> reached(nodes.size(), false);
    reached[node] = true;
    for (std::size_t i = node + 1; i < nodes.size(); ++i)
        reached[i] = std::ranges::any_of(nodes[i].inputs,
                                         [&](const GraphInput& input) { return input.from && reached[*input.from]; });
    return reached;
}

std::vector<bool> Graph::upstream(std::size_t node) const
{
    std::vector<bool> reached(nodes.size(), false);
    reached[node] = true;
    for (std::size_t i = node + 1; i-- > 0;)
        if (reached[i])
            for (const auto& input : nodes[i].inputs)
                if (input.from) reached[*input.from] = true;
    return reached;
}

// The values that the stage gets: the defaults, and those of the pipeline over them.
ParamValues values_of(const GraphNode& node)
{
    ParamValues values;
    for (const auto& spec : node.program.description.params)
        values[spec.name] = spec.default_value;
    for (const auto& param : node.params)
        values[param.name] = param.value;
    return values;
}

bool does_the_same(const Graph& a, const Graph& b)
{
    return std::ranges::equal(a.nodes, b.nodes, [](const GraphNode& left, const GraphNode& right) {
        return left.name == right.name && left.program.path == right.program.path &&
               left.program.leading == right.program.leading && left.inputs == right.inputs &&
               values_of(left) == values_of(right);
    });
}

} // namespace quoin
