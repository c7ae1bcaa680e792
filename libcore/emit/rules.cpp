#include "emit/rules.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace quoin {
namespace {

namespace fs = std::filesystem;

bool is_plain(char c)
{
    return std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_-.+/@,^:=").find(c) != std::string::npos;
}

std::string replace_all(std::string text, const std::string& from, const std::string& to)
{
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

std::string program_text(const fs::path& program, const Emission& emission, const PlaceNames& names)
{
    return program.parent_path() == emission.bin ? names.bin + "/" + program.filename().string() : program.string();
}

std::vector<std::string> argument_texts(const Task& task, const PlaceNames& names)
{
    std::vector<std::string> texts;
    for (const auto& word : task.leading)
        texts.push_back(replace_all(shell_word(word), "$", names.dollar));
    for (const auto& input : task.inputs)
        texts.push_back(fmt::format("--in {}={}", input.port, input.path.string()));
    if (!task.scan_root.empty()) texts.push_back("--scan-root " + task.scan_root.string());
    for (const auto& output : task.outputs)
        texts.push_back(fmt::format("--out {}={}", output.port, output.path.string()));
    for (const auto& setting : task.settings)
        texts.push_back("--set " + replace_all(shell_word(setting), "$", names.dollar));
    return texts;
}

Rule make_rule(const Task& task, const Emission& emission, const PlaceNames& names)
{
    Rule rule;
    rule.stage = task.stage;
    rule.program = program_text(task.program, emission, names);
    for (const auto& file : emission.graph.nodes[task.node].program.code)
        rule.code.push_back(file.string());
    rule.arguments = argument_texts(task, names);
    for (const auto& output : task.outputs)
        rule.outputs.push_back(output.path.string());
    rule.record = task.record.string();
    rule.reads_folder = std::ranges::any_of(
        task.inputs, [&](const TaskInput& input) { return !input.from && input.path == names.folder; });
    return rule;
}

void require_plain(const std::string& text, const std::string& what)
{
    const auto odd = std::ranges::find_if_not(text, [](char c) { return is_plain(c) && c != ':' && c != '='; });
    if (odd != text.end())
        throw UsageError(fmt::format("{} is '{}': Makefiles and Ninja files cannot hold '{}' in a path or name; choose "
                                     "another one (--scan NAME=DIR names a scan, a symbolic link moves a folder)",
                                     what, text, *odd));
}

} // namespace

std::vector<Rule> stage_rules(const Emission& emission, const PlaceNames& names)
{
    const auto has_task = [&](const Task& task) {
        return std::ranges::any_of(emission.tasks, [&](const Task& t) { return t.stage == task.stage; });
    };
    const Layout layout{names.out, {}};
    const auto planned = plan_tasks(emission.graph, {{names.scan, names.folder}}, layout, {});
    std::vector<Rule> rules;
    std::map<std::size_t, std::size_t> rule_of; // by planned task
    for (std::size_t i = 0; i < planned.size(); ++i) {
        if (!has_task(planned[i])) continue;
        rule_of[i] = rules.size();
        rules.push_back(make_rule(planned[i], emission, names));
        for (const std::size_t before : planned[i].after)
            if (rule_of.contains(before)) rules.back().after.push_back(rule_of[before]);
        std::ranges::sort(rules.back().after);
        const auto twice = std::ranges::unique(rules.back().after);
        rules.back().after.erase(twice.begin(), twice.end());
    }
    return rules;
}

std::string code_text(const Rule& rule)
{
    std::string text = rule.program;
    for (const auto& file : rule.code)
        text += " " + file;
    return text;
}

std::vector<const Rule*> last_rules(const std::vector<Rule>& rules)
{
    std::vector<const Rule*> last;
    for (std::size_t i = 0; i < rules.size(); ++i) {
        const auto waits = [&](const Rule& rule) { return std::ranges::find(rule.after, i) != rule.after.end(); };
        if (std::ranges::none_of(rules, waits)) last.push_back(&rules[i]);
    }
    return last;
}

std::string command_text(const Rule& rule, const std::string& more, const std::string& continuation)
{
    constexpr std::size_t kWidth = 110;
    std::string text = rule.program;
    std::size_t column = text.size();
    const auto add = [&](const std::string& word) {
        const bool fits = column + 1 + word.size() <= kWidth;
        text += (fits ? " " : continuation) + word;
        column = (fits ? column + 1 : 4) + word.size();
    };
    for (const auto& argument : rule.arguments)
        add(argument);
    if (!more.empty()) add(more);
    return text;
}

std::string shell_word(const std::string& text)
{
    if (!text.empty() && std::ranges::all_of(text, is_plain)) return text;
    return "'" + replace_all(text, "'", R"('\'')") + "'";
}

void require_plain_names(const Emission& emission)
{
    require_plain(emission.bin.string(), "the folder of the stages");
    require_plain(emission.layout.out.string(), "--out");
    require_plain(emission.layout.store.string(), "--store");
    for (const auto& scan : emission.scans) {
        require_plain(scan.name, "the name of a scan");
        require_plain(scan.folder.string(), fmt::format("the folder of scan '{}'", scan.name));
    }
    for (const auto& node : emission.graph.nodes) {
        require_plain(node.program.path.string(), fmt::format("the program of stage '{}'", node.name));
        for (const auto& file : node.program.code)
            require_plain(file.string(), fmt::format("a file of the program of stage '{}'", node.name));
    }
}

} // namespace quoin
