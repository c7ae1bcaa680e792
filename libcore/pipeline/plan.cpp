#include "pipeline/plan.h"

#include "base/error.h"

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
    for (const auto& node : graph.nodes) names.push_back(node.name);
    throw UsageError(fmt::format("{}: the pipeline has no stage '{}'{}", flag, stage, hint(stage, names)));
}

std::vector<bool> select_nodes(const Graph& graph, const Selection& selection)
{
    std::vector<bool> selected(graph.nodes.size(), true);
    const auto keep = [&](const std::vector<bool>& reached) {
        for (std::size_t i = 0; i < selected.size(); ++i) selected[i] = selected[i] && reached[i];
    };
    if (!selection.from.empty()) keep(graph.downstream(find_stage(graph, selection.from, "--from")));
    if (!selection.until.empty()) keep(graph.upstream(find_stage(graph, selection.until, "--until")));
    for (const auto& stage : selection.force) find_stage(graph, stage, "--force");
    if (std::ranges::none_of(selected, [](bool is_selected) { return is_selected; }))
        throw UsageError(fmt::format("--from {} --until {}: no stage lies between them", selection.from, selection.until));
    return selected;
}

// Makes the tasks of one scan.
class Planner {
public:
    Planner(const Graph& graph, const NamedScan& scan, const Layout& layout) : graph_(graph), scan_(scan), layout_(layout) {}

    Task make(std::size_t index, bool forced) const
    {
        const GraphNode& node = graph_.nodes[index];
        Task task{scan_.name, node.name, index, node.program.path, {}, {}, layout_.record(scan_.name, node.name), {}};
        for (const auto& input : node.inputs) add(task, "--in", input.port + "=" + source(input).string());
        for (const auto& port : node.program.description.outputs) {
            task.outputs.push_back(layout_.output(scan_.name, node.name, port.name, port.schema));
            add(task, "--out", port.name + "=" + task.outputs.back().string());
        }
        for (const auto& param : node.params) add(task, "--set", param.name + "=" + format_param(param.value));
        if (node.program.description.reads_images) add_scan_root(task, index);
        add(task, "--cache", forced ? "off" : "auto");
        add(task, "--store", layout_.store.string());
        add(task, "--record", task.record.string());
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
    static void add(Task& task, const char* flag, std::string value)
    {
        task.arguments.emplace_back(flag);
        task.arguments.push_back(std::move(value));
    }

    void add_scan_root(Task& task, std::size_t index) const
    {
        if (const GraphInput* folder = graph_.scan_folder(index)) add(task, "--scan-root", source(*folder).string());
    }

    const Graph& graph_;
    const NamedScan& scan_;
    const Layout& layout_;
};

void plan_scan(const Graph& graph, const NamedScan& scan, const Layout& layout, const Selection& selection, std::vector<Task>& tasks)
{
    const std::vector<bool> selected = select_nodes(graph, selection);
    const Planner planner(graph, scan, layout);
    std::map<std::size_t, std::size_t> task_of;
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        if (!selected[i]) continue;
        Task task = planner.make(i, std::ranges::find(selection.force, graph.nodes[i].name) != selection.force.end());
        for (const auto& input : graph.nodes[i].inputs) {
            if (input.from && selected[*input.from])
                task.after.push_back(task_of.at(*input.from));
            else if (const fs::path file = planner.source(input); input.from && !fs::exists(file))
                throw InputError(fmt::format("{}: no such file; stage '{}' reads it and --from leaves out stage '{}', which makes it: run without --from once",
                                             file.string(), task.stage, graph.nodes[*input.from].name));
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
    if (!fs::is_directory(folder)) throw InputError(fmt::format("--scan {}: {} is not a folder", argument, folder.string()));
    const fs::path last = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
    NamedScan scan{is_named ? argument.substr(0, equals) : last.string(), folder};
    const bool is_hidden = scan.name.empty() || scan.name.starts_with('.');
    if (is_hidden) throw UsageError(fmt::format("--scan {}: '{}' cannot name a folder of the output; write --scan NAME=DIR", argument, scan.name));
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
            throw UsageError(fmt::format("--scan {}: there is a scan '{}' already; write --scan NAME=DIR", argument, scans.back().name));
    }
    return scans;
}

std::vector<Task> plan_tasks(const Graph& graph, const std::vector<NamedScan>& scans, const Layout& layout, const Selection& selection)
{
    std::vector<Task> tasks;
    for (const auto& scan : scans) plan_scan(graph, scan, layout, selection, tasks);
    return tasks;
}

} // namespace quoin
