#include "pipeline/command_file.h"

#include "base/error.h"
#include "pipeline/placeholders.h"
#include "pipeline/yaml.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <limits>

namespace quoin {
namespace fs = std::filesystem;
namespace {

std::string text_of(const YamlNode& map, const std::string& key, const std::string& otherwise = "")
{
    const YamlNode* node = find(map, key);
    return node && node->is_scalar() ? node->text : otherwise;
}

bool flag_of(const YamlNode& map, const std::string& key, Problems& problems)
{
    const YamlNode* node = find(map, key);
    if (!node) return false;
    if (node->text != "true" && node->text != "false")
        problems.add(node->position, fmt::format("'{}' is expected to be true or false", key));
    return node->text == "true";
}

template <class Number>
Number number_of(const YamlNode& map, const std::string& key, Number otherwise, Problems& problems)
{
    const YamlNode* node = find(map, key);
    if (!node) return otherwise;
    const char* end = node->text.data() + node->text.size();
    if (const auto [at, error] = std::from_chars(node->text.data(), end, otherwise); error != std::errc() || at != end)
        problems.add(node->position, fmt::format("'{}' is expected to be a number", key));
    return otherwise;
}

PortDescription read_port(const YamlEntry& entry, Problems& problems)
{
    PortDescription port{.name = entry.key, .schema = entry.key, .version = 1, .optional = false, .doc = ""};
    if (entry.value.is_null() || !expect_map(entry.value, fmt::format("port '{}'", entry.key), problems)) return port;
    refuse_unknown_keys(entry.value, {"schema", "version", "optional", "doc"}, "a port", problems);
    port.schema = text_of(entry.value, "schema", entry.key);
    port.version = number_of(entry.value, "version", 1, problems);
    port.optional = flag_of(entry.value, "optional", problems);
    port.doc = text_of(entry.value, "doc");
    return port;
}

std::vector<PortDescription> read_ports(const YamlNode& describe, const std::string& key, Problems& problems)
{
    std::vector<PortDescription> ports;
    const YamlNode* map = find(describe, key);
    if (!map || !expect_map(*map, fmt::format("'{}'", key), problems)) return ports;
    for (const auto& entry : map->entries)
        ports.push_back(read_port(entry, problems));
    return ports;
}

std::optional<ParamType> type_of(const std::string& name)
{
    for (const ParamType type :
         {ParamType::Bool, ParamType::Int, ParamType::Float, ParamType::String, ParamType::Choice})
        if (type_name(type) == name) return type;
    return std::nullopt;
}

void read_default(const YamlEntry& entry, ParamSpec& spec, Problems& problems)
{
    const YamlNode* value = find(entry.value, "default");
    if (!value || !value->is_scalar()) {
        problems.add(entry.position, fmt::format("parameter '{}' has no default", spec.name));
        return;
    }
    try {
        spec.default_value = parse_param(spec, value->text, "its default");
    } catch (const UsageError& error) {
        problems.add(value->position, error.what());
    }
}

ParamSpec read_param(const YamlEntry& entry, Problems& problems)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    ParamSpec spec;
    spec.name = entry.key;
    if (!expect_map(entry.value, fmt::format("parameter '{}'", entry.key), problems)) return spec;
    refuse_unknown_keys(entry.value, {"type", "default", "min", "max", "unit", "doc", "choices", "affects_result"},
                        "a parameter", problems);
    const YamlNode* type = find(entry.value, "type");
    if (const auto known = type ? type_of(type->text) : std::nullopt)
        spec.type = *known;
    else
        problems.add(type ? type->position : entry.position,
                     fmt::format("parameter '{}' needs a type: bool, int, float, string or choice", entry.key));
    spec.min = number_of(entry.value, "min", -infinity, problems);
    spec.max = number_of(entry.value, "max", infinity, problems);
    spec.unit = text_of(entry.value, "unit");
    spec.doc = text_of(entry.value, "doc");
    if (const YamlNode* choices = find(entry.value, "choices"))
        for (const auto& choice : choices->items)
            spec.choices.push_back(choice.text);
    spec.flags.affects_result =
        !find(entry.value, "affects_result") || flag_of(entry.value, "affects_result", problems);
    read_default(entry, spec, problems);
    return spec;
}

StageDescription read_description(const YamlNode& describe, const std::string& name, Problems& problems)
{
    StageDescription stage;
    stage.name = text_of(describe, "name", name);
    if (!expect_map(describe, "'describe'", problems)) return stage;
    refuse_unknown_keys(describe, {"name", "summary", "impl_version", "reads_images", "inputs", "outputs", "params"},
                        "'describe'", problems);
    stage.summary = text_of(describe, "summary");
    stage.impl_version = number_of(describe, "impl_version", 1, problems);
    stage.reads_images = flag_of(describe, "reads_images", problems);
    stage.inputs = read_ports(describe, "inputs", problems);
    stage.outputs = read_ports(describe, "outputs", problems);
    if (stage.outputs.empty()) problems.add(describe.position, fmt::format("stage '{}' has no outputs", stage.name));
    if (const YamlNode* params = find(describe, "params"); params && expect_map(*params, "'params'", problems))
        for (const auto& entry : params->entries)
            stage.params.push_back(read_param(entry, problems));
    return stage;
}

std::vector<std::string> known_placeholders(const StageDescription& stage)
{
    std::vector<std::string> names{"threads"};
    if (stage.reads_images) names.emplace_back("scan_root");
    for (const auto& port : stage.inputs)
        names.push_back("in." + port.name);
    for (const auto& port : stage.outputs)
        names.push_back("out." + port.name);
    for (const auto& param : stage.params)
        names.push_back("param." + param.name);
    return names;
}

// A word that names a file beside the YAML file means that file, wherever the command runs.
void read_word(const YamlNode& node, const fs::path& folder, CommandFile& command, Problems& problems)
{
    const auto known = known_placeholders(command.description);
    const auto names = placeholders_in(node.text);
    for (const auto& name : names)
        if (std::ranges::find(known, name) == known.end())
            problems.add(node.position, fmt::format("there is no placeholder '{{{}}}'{}", name, hint(name, known)));
    const fs::path file = fs::absolute(folder / node.text).lexically_normal();
    const bool is_file = names.empty() && !node.text.empty() && fs::is_regular_file(file);
    if (is_file) command.code.push_back(file);
    command.exec.push_back(is_file ? file.string() : node.text);
    command.words.push_back(node.text);
}

void read_exec(const YamlNode& map, const fs::path& folder, CommandFile& command, Problems& problems)
{
    const YamlNode* exec = find(map, "exec");
    if (!exec || exec->items.empty()) {
        problems.add(exec ? exec->position : map.position,
                     "'exec' is expected to be a list of words: [program, \"{in.PORT}\", ...]");
        return;
    }
    for (const auto& word : exec->items)
        read_word(word, folder, command, problems);
}

void read_code(const YamlNode& map, const fs::path& folder, CommandFile& command, Problems& problems)
{
    const YamlNode* code = find(map, "code");
    if (!code) return;
    for (const auto& item : code->items) {
        const fs::path file = fs::absolute(folder / item.text).lexically_normal();
        if (!fs::is_regular_file(file))
            problems.add(item.position, fmt::format("{}: no such file", file.string()));
        else if (std::ranges::find(command.code, file) == command.code.end())
            command.code.push_back(file);
    }
}

// Where "#stage" begins, or the end.
std::size_t hash_in(const std::string& use)
{
    const std::size_t hash = use.rfind('#');
    const std::size_t slash = use.rfind('/');
    return hash == std::string::npos || (slash != std::string::npos && slash > hash) ? use.size() : hash;
}

std::string stage_in(const std::string& use)
{
    const std::size_t hash = hash_in(use);
    return hash == use.size() ? "" : use.substr(hash + 1);
}

} // namespace

fs::path command_file_path(const std::string& use) { return use.substr(0, hash_in(use)); }

bool is_command_file(const std::string& use)
{
    const fs::path extension = command_file_path(use).extension();
    return extension == ".yaml" || extension == ".yml";
}

CommandFile read_command_file(const std::string& use, Problems& problems)
{
    const fs::path path = command_file_path(use);
    const std::string stage = stage_in(use);
    const YamlNode document = load_yaml(path, problems);
    const YamlNode* stages = stage.empty() ? nullptr : find(document, "stages");
    const YamlNode* map = stage.empty() ? &document : stages ? find(*stages, stage) : nullptr;
    CommandFile command;
    if (!map || !map->is_map()) {
        problems.add(document.position, fmt::format("{} describes no command line (exec: [...])", use));
        return command;
    }
    if (stage.empty()) refuse_unknown_keys(*map, {"exec", "code", "describe"}, "a described command line", problems);
    const YamlNode* describe = find(*map, "describe");
    if (!describe) problems.add(map->position, "'describe' is missing: inputs, outputs and params of the command line");
    if (describe)
        command.description = read_description(*describe, stage.empty() ? path.stem().string() : stage, problems);
    read_exec(*map, path.parent_path(), command, problems);
    read_code(*map, path.parent_path(), command, problems);
    return command;
}

} // namespace quoin
