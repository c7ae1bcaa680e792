#include "pipeline/graph.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

// A stage of the pipeline next to the program it uses; nullptr where that was refused.
struct Resolved {
    const PipelineStage* stage;
    const Program* program;
};

std::vector<Resolved> find_programs(const Pipeline& pipeline, Catalogue& catalogue, Problems& problems)
{
    std::vector<std::filesystem::path> paths;
    for (const auto& stage : pipeline.stages)
        paths.push_back(catalogue.locate(stage.use, stage.use_folder));
    catalogue.prepare(paths);
    std::vector<Resolved> resolved;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const PipelineStage& stage = pipeline.stages[i];
        resolved.push_back({&stage, nullptr});
        if (stage.use.empty()) continue; // was refused on reading
        try {
            if (!names_a_path(stage.use) && !std::filesystem::exists(paths[i]))
                problems.add(stage.use_position,
                             fmt::format("there is no stage '{}'{}", stage.use, hint(stage.use, catalogue.names())));
            else
                resolved[i].program = &catalogue.describe(paths[i]);
        } catch (const UsageError& error) {
            problems.add(stage.use_position, error.what());
        }
    }
    return resolved;
}

const Resolved* find_stage(const std::vector<Resolved>& stages, const std::string& name)
{
    const auto it = std::ranges::find_if(stages, [&](const Resolved& r) { return r.stage->name == name; });
    return it == stages.end() ? nullptr : &*it;
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

void check_wire(const std::vector<Resolved>& stages, const PortDescription& input, const Wire& wire, Problems& problems)
{
    if (wire.stage.empty()) {
        if (input.schema != "folder")
            problems.add(wire.position,
                         fmt::format("$scan is a folder, but input '{}' takes a {}", input.name, schema_text(input)));
        return;
    }
    const Resolved* source = find_stage(stages, wire.stage);
    if (!source) {
        std::vector<std::string> names;
        for (const auto& r : stages)
            names.push_back(r.stage->name);
        problems.add(wire.position,
                     fmt::format("the pipeline has no stage '{}'{}", wire.stage, hint(wire.stage, names)));
    } else if (source->program) {
        const auto& outputs = source->program->description.outputs;
        if (const PortDescription* output = find_port(outputs, wire.port))
            check_schema(*output, input, wire, problems);
        else
            problems.add(wire.position, fmt::format("stage '{}' has no output '{}'{}", wire.stage, wire.port,
                                                    hint(wire.port, port_names(outputs))));
    }
}

void check_inputs(const std::vector<Resolved>& stages, const Resolved& resolved, Problems& problems)
{
    const PipelineStage& stage = *resolved.stage;
    const auto& ports = resolved.program->description.inputs;
    for (const auto& [name, wire] : stage.inputs) {
        if (const PortDescription* port = find_port(ports, name))
            check_wire(stages, *port, wire, problems);
        else
            problems.add(wire.position, fmt::format("stage '{}' has no input '{}'{}", stage.name, name,
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
            problems.add(setting.position, fmt::format("stage '{}' has no parameter '{}'{}", resolved.stage->name, name,
                                                       hint(name, names)));
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

bool is_placed(const std::vector<const Resolved*>& order, const std::string& name)
{
    return std::ranges::any_of(order, [&](const Resolved* r) { return r->stage->name == name; });
}

// Kahn's algorithm; of the stages that could come next, the first of the file. Stages on a circle or behind one are
// left out.
std::vector<const Resolved*> in_running_order(const std::vector<Resolved>& stages)
{
    std::vector<const Resolved*> order;
    const auto is_waited_for = [&](const std::string& name) {
        return find_stage(stages, name) && !is_placed(order, name);
    };
    const auto can_run = [&](const Resolved& r) {
        return !is_placed(order, r.stage->name) && std::ranges::none_of(r.stage->inputs, [&](const auto& input) {
            return is_waited_for(input.second.stage);
        });
    };
    for (auto next = std::ranges::find_if(stages, can_run); next != stages.end();
         next = std::ranges::find_if(stages, can_run))
        order.push_back(&*next);
    return order;
}

// Follows wires backwards among the stages that could not be placed until one comes a second time.
std::vector<std::string> find_circle(const std::vector<Resolved>& stages, const std::vector<const Resolved*>& order)
{
    const auto start =
        std::ranges::find_if(stages, [&](const Resolved& r) { return !is_placed(order, r.stage->name); });
    std::vector<std::string> path;
    std::string at = start->stage->name;
    while (std::ranges::find(path, at) == path.end()) {
        path.push_back(at);
        for (const auto& [port, wire] : find_stage(stages, path.back())->stage->inputs)
            if (find_stage(stages, wire.stage) && !is_placed(order, wire.stage)) at = wire.stage;
    }
    path.erase(path.begin(), std::ranges::find(path, at));
    path.push_back(at);
    std::ranges::reverse(path);
    return path;
}

void check_circles(const std::vector<Resolved>& stages, Problems& problems)
{
    const auto order = in_running_order(stages);
    if (order.size() == stages.size()) return;
    const auto circle = find_circle(stages, order);
    problems.add(find_stage(stages, circle.front())->stage->position,
                 fmt::format("stages wait for each other: {}", fmt::join(circle, " -> ")));
}

GraphNode make_node(const Resolved& resolved, std::vector<GraphParam> params, const Graph& graph)
{
    GraphNode node{resolved.stage->name, *resolved.program, {}, std::move(params)};
    for (const auto& port : resolved.program->description.inputs)
        if (const auto wire = resolved.stage->inputs.find(port.name); wire != resolved.stage->inputs.end())
            node.inputs.push_back({port.name, graph.find(wire->second.stage), wire->second.port});
    return node;
}

} // namespace

Graph build_graph(const Pipeline& pipeline, Catalogue& catalogue, Problems problems)
{
    const auto stages = find_programs(pipeline, catalogue, problems);
    std::vector<std::vector<GraphParam>> params(stages.size());
    for (std::size_t i = 0; i < stages.size(); ++i) {
        if (!stages[i].program) continue;
        check_inputs(stages, stages[i], problems);
        params[i] = check_params(stages[i], problems);
    }
    check_circles(stages, problems);
    problems.throw_if_any();

    Graph graph{pipeline.name, {}};
    for (const Resolved* resolved : in_running_order(stages))
        graph.nodes.push_back(make_node(*resolved, params[static_cast<std::size_t>(resolved - stages.data())], graph));
    return graph;
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

} // namespace quoin
