#include "pipeline/pipeline_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "pipeline/catalogue.h"
#include "pipeline/glob.h"
#include "pipeline/locate.h"
#include "pipeline/scan_name.h"
#include "pipeline/yaml.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <vector>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kScan = "$scan";
constexpr const char* kVersion = "1";
constexpr int kMaxExtends = 8; // deeper chains are circles

// A name becomes a folder of the output and one half of "stage.port".
bool is_name(const std::string& text)
{
    const auto allowed = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_'; };
    return !text.empty() && std::ranges::all_of(text, allowed) && text.front() != '-';
}

void read_wire(const YamlEntry& entry, PipelineStage& stage, Problems& problems)
{
    if (entry.value.is_null()) {
        stage.inputs.erase(entry.key);
        return;
    }
    const std::string& text = entry.value.text;
    const std::size_t dot = text.rfind('.');
    if (entry.value.is_scalar() && text == kScan)
        stage.inputs[entry.key] = {"", "", entry.value.position, entry.position};
    else if (entry.value.is_scalar() && dot != std::string::npos && dot > 0 && dot + 1 < text.size())
        stage.inputs[entry.key] = {text.substr(0, dot), text.substr(dot + 1), entry.value.position, entry.position};
    else
        problems.add(entry.value.position,
                     fmt::format("input '{}' of stage '{}' is expected to come from stage.port or {}", entry.key,
                                 stage.name, kScan));
}

void set_use(PipelineStage& stage, const std::string& use, const fs::path& folder, const Position& position)
{
    stage.use = use;
    stage.use_folder = folder;
    stage.use_position = position;
    stage.code.clear(); // was that of another program
}

void read_params(const YamlNode& map, PipelineStage& stage, Problems& problems)
{
    if (map.is_null() || !expect_map(map, fmt::format("'params' of stage '{}'", stage.name), problems)) return;
    for (const auto& entry : map.entries) {
        if (entry.value.is_null())
            stage.params.erase(entry.key);
        else if (entry.value.is_scalar())
            stage.params[entry.key] = {entry.value.text, entry.value.position, entry.position};
        else
            problems.add(entry.value.position, fmt::format("parameter '{}' takes one value", entry.key));
    }
}

// A program by name or path, or a command line that the same map describes (command_file.h).
void read_use(const YamlNode& map, const fs::path& folder, PipelineStage& stage, Problems& problems)
{
    const YamlNode* use = find(map, "use");
    const YamlNode* exec = find(map, "exec");
    if (use && exec) problems.add(exec->position, "a stage has 'use' or 'exec', not both");
    if (use && (!use->is_scalar() || use->text.empty()))
        problems.add(use->position, "'use' is expected to name a stage, or the path of a program");
    else if (use)
        set_use(stage, use->text, folder, use->position);
    else if (exec)
        set_use(stage, fs::absolute(exec->position.source->name).string() + "#" + stage.name, folder, exec->position);
    const YamlNode* code = exec ? nullptr : find(map, "code");
    if (!code) return;
    stage.code.clear();
    for (const auto& item : code->items)
        stage.code.push_back(fs::absolute(folder / item.text).lexically_normal());
}

void read_stage(const YamlNode& map, const fs::path& folder, PipelineStage& stage, Problems& problems)
{
    if (!expect_map(map, fmt::format("stage '{}'", stage.name), problems)) return;
    refuse_unknown_keys(map, {"use", "exec", "describe", "code", "in", "params"}, "a stage", problems);
    read_use(map, folder, stage, problems);
    if (const YamlNode* in = find(map, "in"); in && !in->is_null() && expect_map(*in, "'in'", problems))
        for (const auto& entry : in->entries)
            read_wire(entry, stage, problems);
    if (const YamlNode* params = find(map, "params")) read_params(*params, stage, problems);
    if (stage.use.empty())
        problems.add(stage.position,
                     fmt::format("stage '{}' does not say which stage it uses (use: NAME)", stage.name));
}

void check_version(const YamlNode& document, Problems& problems)
{
    const YamlNode* version = find(document, "version");
    if (!version)
        problems.add(document.position,
                     fmt::format("the pipeline does not say its version; this build reads 'version: {}'", kVersion));
    else if (version->text != kVersion)
        problems.add(version->position, fmt::format("version '{}' of the pipeline format; this build reads version {}",
                                                    version->text, kVersion));
}

Pipeline parse(const fs::path& path, const std::string& text, int depth, Problems& problems);

// The file that `extends` means: beside this one, or one of Quoin's own by its name.
fs::path find_extended(const YamlNode& extends, const fs::path& folder, Problems& problems)
{
    if (!extends.is_scalar() || extends.text.empty()) {
        problems.add(extends.position, "'extends' is expected to name one pipeline");
        return {};
    }
    if (fs::path path = folder / extends.text; fs::is_regular_file(path)) return path;
    try {
        if (!extends.text.ends_with(".yaml") && !names_a_path(extends.text))
            return find_yaml("pipelines", extends.text);
        problems.add(extends.position, fmt::format("{}: no such file", (folder / extends.text).string()));
    } catch (const UsageError& error) {
        problems.add(extends.position, error.what());
    }
    return {};
}

// The pipeline that this one extends, or an empty one.
Pipeline read_base(const YamlNode& document, const fs::path& folder, int depth, Problems& problems)
{
    const YamlNode* extends = find(document, "extends");
    if (!extends || extends->is_null()) return {};
    const fs::path path = find_extended(*extends, folder, problems);
    if (path.empty()) return {};
    if (depth >= kMaxExtends) {
        problems.add(extends->position, "pipelines extend each other in a circle");
        return {};
    }
    return parse(path, read_text(path), depth + 1, problems);
}

std::string scan_argument(const std::string& name, const YamlNode& place, const fs::path& folder, Problems& problems)
{
    if (!place.is_scalar() || place.text.empty()) {
        problems.add(place.position, "a scan is expected to be the path of a folder");
        return {};
    }
    const std::string path = fs::absolute(folder / place.text).lexically_normal().string();
    return name.empty() ? path : name + "=" + path;
}

// A scan in a list is named as its folder is; two of one name would overwrite each other's results.
void refuse_equal_names(const std::vector<YamlNode>& list, Problems& problems)
{
    std::map<std::string, int> line_of;
    for (const auto& item : list) {
        if (!item.is_scalar() || item.text.empty()) continue;
        const std::string name = scan_name(item.text);
        const auto [first, is_new] = line_of.emplace(name, item.position.line);
        if (!is_new)
            problems.add(
                item.position,
                fmt::format("a scan '{}' stands in line {} already; name each: {{NAME: FOLDER}}", name, first->second));
    }
}

std::vector<std::string> read_scans(const YamlNode& scans, const fs::path& folder, Problems& problems)
{
    std::vector<std::string> arguments;
    refuse_equal_names(scans.items, problems);
    for (const auto& item : scans.items)
        arguments.push_back(scan_argument("", item, folder, problems));
    if (const YamlNode* pattern = find(scans, "glob"); pattern && scans.entries.size() == 1) {
        for (const auto& match : glob(scan_argument("", *pattern, folder, problems)))
            if (fs::is_directory(match)) arguments.push_back(match.string());
        if (arguments.empty()) problems.add(pattern->position, fmt::format("no folder is like '{}'", pattern->text));
        return arguments;
    }
    for (const auto& entry : scans.entries)
        arguments.push_back(scan_argument(entry.key, entry.value, folder, problems));
    if (scans.is_scalar())
        problems.add(scans.position, "'scans' is a list of folders, a map {name: folder} or {glob: PATTERN}");
    return arguments;
}

void read_study(const YamlNode& document, const fs::path& folder, Pipeline& pipeline)
{
    for (const char* key : {"variants", "matrix", "ablate", "report"})
        if (const YamlNode* section = find(document, key)) pipeline.study.push_back({key, *section, folder});
}

Pipeline parse(const fs::path& path, const std::string& text, int depth, Problems& problems)
{
    const YamlNode document = parse_yaml(path.string(), text, problems);
    if (problems.has_errors() && document.is_null()) return {};
    if (!expect_map(document, "a pipeline", problems)) return {};
    refuse_unknown_keys(document, {"version", "extends", "scans", "stages", "variants", "matrix", "ablate", "report"},
                        "a pipeline", problems);
    check_version(document, problems);
    const fs::path folder = path.parent_path();
    Pipeline pipeline = read_base(document, folder, depth, problems);
    pipeline.name = path.stem().string();
    if (const YamlNode* scans = find(document, "scans")) pipeline.scans = read_scans(*scans, folder, problems);
    if (const YamlNode* stages = find(document, "stages")) apply_stages(pipeline, *stages, folder, problems);
    read_study(document, folder, pipeline);
    if (pipeline.stages.empty() && !problems.has_errors())
        problems.add(document.position, "the pipeline has no stages");
    return pipeline;
}

} // namespace

Pipeline parse_pipeline(const fs::path& path, const std::string& text, Problems& problems)
{
    return parse(path, text, 0, problems);
}

Pipeline read_pipeline(const fs::path& path, Problems& problems)
{
    if (!fs::is_regular_file(path)) throw UsageError(fmt::format("{}: no such file", path.string()));
    return parse(path, read_text(path), 0, problems);
}

void apply_stages(Pipeline& pipeline, const YamlNode& map, const fs::path& folder, Problems& problems)
{
    if (map.is_null() || !expect_map(map, "'stages'", problems)) return;
    for (const auto& entry : map.entries) {
        if (!is_name(entry.key)) {
            problems.add(entry.position,
                         fmt::format("'{}' cannot name a stage: letters, digits, '-' and '_' can", entry.key));
            continue;
        }
        if (entry.value.is_null()) {
            std::erase_if(pipeline.stages, [&](const PipelineStage& stage) { return stage.name == entry.key; });
            continue;
        }
        if (!pipeline.find(entry.key)) pipeline.stages.emplace_back();
        PipelineStage& stage = pipeline.find(entry.key) ? *pipeline.find(entry.key) : pipeline.stages.back();
        stage.name = entry.key;
        stage.position = entry.position;
        read_stage(entry.value, folder, stage, problems);
    }
}

void apply_config(Pipeline& pipeline, const fs::path& path, Problems& problems)
{
    const YamlNode document = load_yaml(path, problems);
    if (document.is_null() || !expect_map(document, "a parameter set", problems)) return;
    for (const auto& entry : document.entries) {
        if (PipelineStage* stage = pipeline.find(entry.key))
            read_params(entry.value, *stage, problems);
        else
            problems.add(entry.position, fmt::format("the pipeline has no stage '{}'{}", entry.key,
                                                     hint(entry.key, pipeline.stage_names())));
    }
}

void apply_setting(Pipeline& pipeline, const std::string& argument, Problems& problems)
{
    const std::size_t equals = argument.find('=');
    const std::size_t dot = argument.find('.');
    if (dot == std::string::npos || equals == std::string::npos || dot > equals) {
        problems.add(argument_position("-S", argument), "expected stage.param=value");
        return;
    }
    const std::string name = argument.substr(0, dot);
    const auto at = [&](std::size_t column) { return argument_position("-S", argument, static_cast<int>(column) + 1); };
    if (PipelineStage* stage = pipeline.find(name))
        stage->params[argument.substr(dot + 1, equals - dot - 1)] = {argument.substr(equals + 1), at(equals + 1),
                                                                     at(dot + 1)};
    else
        problems.add(argument_position("-S", argument),
                     fmt::format("the pipeline has no stage '{}'{}", name, hint(name, pipeline.stage_names())));
}

void apply_use(Pipeline& pipeline, const std::string& argument, Problems& problems)
{
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos || equals + 1 == argument.size()) {
        problems.add(argument_position("--use", argument), "expected stage=PROGRAM");
        return;
    }
    const std::string name = argument.substr(0, equals);
    PipelineStage* stage = pipeline.find(name);
    if (!stage) {
        problems.add(argument_position("--use", argument),
                     fmt::format("the pipeline has no stage '{}'{}", name, hint(name, pipeline.stage_names())));
        return;
    }
    set_use(*stage, argument.substr(equals + 1), fs::current_path(),
            argument_position("--use", argument, static_cast<int>(equals) + 2));
}

} // namespace quoin
