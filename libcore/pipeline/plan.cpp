#include "pipeline/plan.h"

#include "base/error.h"
#include "pipeline/scan_name.h"
#include "store/identity.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace quoin {
namespace fs = std::filesystem;
namespace {

std::size_t find_stage(const Graph& graph, const std::string& stage, const std::string& flag)
{
    if (const auto node = graph.find(stage)) return *node;
    std::vector<std::string> names;
    for (const auto& node : graph.nodes)
        names.push_back(node.name);
    throw UsageError(fmt::format("{}: the pipeline has no stage '{}'{}", flag, stage, hint(stage, names)));
}

std::vector<bool> select_nodes(const Graph& graph, const Selection& selection)
{
    std::vector<bool> selected(graph.nodes.size(), true);
    const auto keep = [&](const std::vector<bool>& reached) {
        for (std::size_t i = 0; i < selected.size(); ++i)
            selected[i] = selected[i] && reached[i];
    };
    if (!selection.from.empty()) keep(graph.downstream(find_stage(graph, selection.from, "--from")));
    if (!selection.until.empty()) keep(graph.upstream(find_stage(graph, selection.until, "--until")));
    for (const auto& stage : selection.force)
        find_stage(graph, stage, "--force");
    if (std::ranges::none_of(selected, [](bool is_selected) { return is_selected; }))
        throw UsageError(
            fmt::format("--from {} --until {}: no stage lies between them", selection.from, selection.until));
    return selected;
}

using NodeKeys = std::vector<std::shared_ptr<const KeyParts>>; // one a node; the tasks of all scans share them
using NodeDescriptions = std::vector<std::shared_ptr<const StageDescription>>; // the same

NodeDescriptions descriptions(const Graph& graph)
{
    NodeDescriptions shared;
    for (const auto& node : graph.nodes)
        shared.push_back(std::make_shared<const StageDescription>(node.program.description));
    return shared;
}

NodeKeys key_parts(const Graph& graph)
{
    NodeKeys keys;
    for (const auto& node : graph.nodes) {
        const StageDescription& stage = node.program.description;
        if (stage.implementation.empty() ||
            !node.program.leading.empty()) { // run-command keys foreign programs by their code
            keys.push_back(nullptr);
            continue;
        }
        KeyParts parts{stage.name, stage.implementation, stage.impl_version, {}, {}, {}};
        for (const auto& port : stage.outputs)
            parts.outputs[port.name] = versioned_schema(port.schema, port.version);
        parts.params = key_params(stage.params, values_of(node));
        keys.push_back(std::make_shared<const KeyParts>(std::move(parts)));
    }
    return keys;
}

// Makes the tasks of one scan.
class Planner {
public:
    Planner(const Graph& graph, const NamedScan& scan, const Layout& layout, const NodeKeys& keys,
            const NodeDescriptions& descriptions)
        : graph_(graph), scan_(scan), layout_(layout), keys_(keys), descriptions_(descriptions)
    {
    }

    Task make(std::size_t index) const
    {
        const GraphNode& node = graph_.nodes[index];
        Task task;
        task.scan = scan_.name;
        task.stage = node.name;
        task.node = index;
        task.program = node.program.path;
        task.leading = node.program.leading;
        task.key = keys_[index];
        task.description = descriptions_[index];
        for (const auto& input : node.inputs)
            task.inputs.push_back({input.port,
                                   source(input),
                                   {},
                                   input.from_port,
                                   find_port(node.program.description.inputs, input.port)->schema});
        for (const auto& port : node.program.description.outputs)
            task.outputs.push_back(
                {port.name, layout_.output(scan_.name, node.name, port.name, port.schema), port.schema});
        for (const auto& param : node.params)
            task.settings.push_back(param.name + "=" + format_param(param.value));
        const GraphInput* folder = node.program.description.reads_images ? graph_.scan_folder(index) : nullptr;
        if (folder) task.scan_root = source(*folder);
        task.record = layout_.record(scan_.name, node.name);
        return task;
    }

    // Where an input lies.
    fs::path source(const GraphInput& input) const
    {
        if (!input.from) return scan_.folder;
        const GraphNode& from = graph_.nodes[*input.from];
        const PortDescription* port = find_port(from.program.description.outputs, input.from_port);
        return layout_.output(scan_.name, from.name, port->name, port->schema);
    }

private:
    const Graph& graph_;
    const NamedScan& scan_;
    const Layout& layout_;
    const NodeKeys& keys_;
    const NodeDescriptions& descriptions_;
};

// A result that is relied on without being made must be there.
void require_result(const Task& task, const TaskInput& input, const std::string& made_by)
{
    if (fs::exists(input.path)) return;
    throw InputError(fmt::format("{}: no such file; stage '{}' reads it and --from leaves out stage '{}', which makes "
                                 "it: run without --from once",
                                 input.path.string(), task.stage, made_by));
}

void plan_scan(const Graph& graph, const Planner& planner, const Selection& selection, std::vector<Task>& tasks)
{
    const std::vector<bool> selected = select_nodes(graph, selection);
    std::map<std::size_t, std::size_t> task_of; // by node
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        if (!selected[i]) continue;
        Task task = planner.make(i);
        task.is_forced = std::ranges::find(selection.force, task.stage) != selection.force.end();
        for (std::size_t k = 0; k < task.inputs.size(); ++k) {
            const auto from = graph.nodes[i].inputs[k].from;
            if (!from) continue;
            if (!selected[*from])
                require_result(task, task.inputs[k], graph.nodes[*from].name);
            else
                task.after.push_back(*(task.inputs[k].from = task_of.at(*from)));
        }
        task_of[i] = tasks.size();
        tasks.push_back(std::move(task));
    }
}

NamedScan parse_scan(const std::string& argument)
{
    const std::size_t equals = argument.find('=');
    const bool is_named = equals != std::string::npos && argument.find('/') > equals && !fs::is_directory(argument);
    const fs::path folder = fs::absolute(is_named ? argument.substr(equals + 1) : argument).lexically_normal();
    if (!fs::is_directory(folder))
        throw InputError(fmt::format("--scan {}: {} is not a folder", argument, folder.string()));
    NamedScan scan{is_named ? argument.substr(0, equals) : scan_name(folder), folder};
    const bool is_hidden = scan.name.empty() || scan.name.starts_with('.');
    if (is_hidden)
        throw UsageError(fmt::format("--scan {}: '{}' cannot name a folder of the output; write --scan NAME=DIR",
                                     argument, scan.name));
    return scan;
}

} // namespace

std::vector<NamedScan> parse_scans(const std::vector<std::string>& arguments)
{
    std::vector<NamedScan> scans;
    std::set<std::string> names;
    for (const auto& argument : arguments) {
        scans.push_back(parse_scan(argument));
        if (!names.insert(scans.back().name).second)
            throw UsageError(fmt::format("--scan {}: there is a scan '{}' already; write --scan NAME=DIR", argument,
                                         scans.back().name));
    }
    return scans;
}

std::vector<Task> plan_tasks(const Graph& graph, const std::vector<NamedScan>& scans, const Layout& layout,
                             const Selection& selection)
{
    std::vector<Task> tasks;
    const NodeKeys keys = key_parts(graph);
    const NodeDescriptions shared = descriptions(graph);
    for (const auto& scan : scans)
        plan_scan(graph, Planner(graph, scan, layout, keys, shared), selection, tasks);
    return tasks;
}

void wait_for_equal_tasks(std::vector<Task>& tasks)
{
    std::map<std::string, std::size_t> first_of;  // by what the task does
    std::vector<std::size_t> first(tasks.size()); // the first task that does the same
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        std::string work = tasks[i].program.string();
        for (const auto& word : tasks[i].leading)
            work += '\n' + word;
        for (const auto& setting : tasks[i].settings)
            work += '\n' + setting;
        for (const auto& input : tasks[i].inputs)
            work += '\n' + input.port + '\n' +
                    (input.from ? fmt::format("{}.{}", first[*input.from], input.from_port) : input.path.string());
        first[i] = first_of.emplace(std::move(work), i).first->second;
        if (first[i] != i) tasks[i].after.push_back(first[i]);
    }
}

std::vector<std::string> arguments_of(const Task& task, const fs::path& store)
{
    std::vector<std::string> arguments = task.leading;
    const auto add = [&](const char* flag, std::string value) {
        arguments.emplace_back(flag);
        arguments.push_back(std::move(value));
    };
    for (const auto& input : task.inputs)
        add("--in", input.port + "=" + input.path.string());
    for (const auto& output : task.outputs)
        add("--out", output.port + "=" + output.path.string());
    for (const auto& setting : task.settings)
        add("--set", setting);
    if (!task.scan_root.empty()) add("--scan-root", task.scan_root.string());
    add("--cache", task.is_forced ? "off" : "auto");
    add("--store", store.string());
    add("--record", task.record.string());
    return arguments;
}

} // namespace quoin
