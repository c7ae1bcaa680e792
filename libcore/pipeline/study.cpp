#include "pipeline/study.h"

#include "base/error.h"
#include "pipeline/locate.h"
#include "pipeline/pipeline_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <set>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kBaseline = "baseline";
constexpr const char* kVariantAxis = "variant";

// One thing that is changed: "simplify.max_error" to "0.01", "merge.use" to "./mine", "variant" to "no-lines".
struct Choice {
    std::string axis;
    std::string value;
    Position axis_position, value_position;
    fs::path folder; // that relative programs are in
};

struct Axis {
    std::string name;
    std::vector<Choice> choices;
};

struct NamedSection {
    std::string name;
    Position position;
    const YamlNode* value;
    fs::path folder;
};

// The variants that the files describe, by name; a later one of the same name takes the place of an earlier one.
std::vector<NamedSection> described_variants(const Pipeline& pipeline, Problems& problems)
{
    std::vector<NamedSection> variants;
    for (const auto& section : pipeline.study) {
        if (section.key != "variants" || section.value.is_null()) continue;
        if (!expect_map(section.value, "'variants'", problems)) continue;
        for (const auto& [name, position, value] : section.value.entries) {
            const bool is_folder_name = !name.empty() && name.front() != '.' && name.find('/') == std::string::npos;
            if (!is_folder_name || name == kBaseline)
                problems.add(position,
                             fmt::format("'{}' cannot name a variant: it names a folder of the output", name));
            std::erase_if(variants, [&](const NamedSection& v) { return v.name == name; });
            if (!value.is_null() && is_folder_name) variants.push_back({name, position, &value, section.folder});
        }
    }
    return variants;
}

// The last that the files say of it.
const StudySection* find_section(const Pipeline& pipeline, const std::string& key)
{
    const StudySection* found = nullptr;
    for (const auto& section : pipeline.study)
        if (section.key == key) found = section.value.is_null() ? nullptr : &section;
    return found;
}

// The scalars of a list, or a single one.
std::vector<const YamlNode*> scalars(const YamlNode& node, const std::string& what, Problems& problems)
{
    std::vector<const YamlNode*> found;
    if (node.is_scalar()) return {&node};
    if (node.kind != YamlNode::Kind::List) problems.add(node.position, what + " is expected to be a list");
    for (const auto& item : node.items) {
        if (item.is_scalar())
            found.push_back(&item);
        else
            problems.add(item.position, what + " holds plain words and numbers only");
    }
    return found;
}

class Maker {
public:
    Maker(const Pipeline& pipeline, Problems& problems)
        : pipeline_(pipeline), problems_(problems), described_(described_variants(pipeline, problems))
    {
    }

    std::vector<std::string> described_names() const
    {
        std::vector<std::string> names;
        for (const auto& variant : described_)
            names.push_back(variant.name);
        return names;
    }

    // Lays one variant of `variants:` over `over`.
    void apply_variant(Pipeline& over, const std::string& name, const Position& position)
    {
        const auto found = std::ranges::find(described_, name, &NamedSection::name);
        if (found == described_.end())
            problems_.add(position, fmt::format("there is no variant '{}'{}", name, hint(name, described_names())));
        else
            apply_overlay(over, *found->value, found->folder, fmt::format("variant '{}'", name));
    }

    void apply(Pipeline& over, const Choice& choice)
    {
        if (choice.axis == kVariantAxis) return apply_variant(over, choice.value, choice.value_position);
        const std::size_t dot = choice.axis.find('.');
        const std::string stage_name = choice.axis.substr(0, dot);
        const std::string param = dot == std::string::npos ? "" : choice.axis.substr(dot + 1);
        PipelineStage* stage = over.find(stage_name);
        if (!stage || param.empty()) {
            problems_.add(choice.axis_position,
                          fmt::format("'{}' is expected to be stage.param, stage.use or variant{}", choice.axis,
                                      hint(stage_name, over.stage_names())));
        } else if (param == "use") {
            stage->use = choice.value;
            stage->use_position = choice.value_position;
            stage->use_folder = choice.folder;
        } else {
            stage->params[param] = {choice.value, choice.value_position, choice.axis_position};
        }
    }

    std::vector<Choice> read_choices(const YamlNode& map, const fs::path& folder, const std::string& what)
    {
        std::vector<Choice> choices;
        if (map.is_null() || !expect_map(map, what, problems_)) return choices;
        for (const auto& [axis, position, value] : map.entries) {
            if (value.is_scalar())
                choices.push_back({axis, value.text, position, value.position, folder});
            else
                problems_.add(value.position, fmt::format("'{}' takes one value here", axis));
        }
        return choices;
    }

    std::vector<Axis> read_axes(const YamlNode& map, const fs::path& folder, const std::string& what)
    {
        std::vector<Axis> axes;
        if (map.is_null() || !expect_map(map, what, problems_)) return axes;
        for (const auto& [name, position, value] : map.entries) {
            if (name == "include" || name == "exclude") continue;
            Axis axis{name, {}};
            for (const YamlNode* node : scalars(value, fmt::format("'{}'", name), problems_))
                axis.choices.push_back({name, node->text, position, node->position, folder});
            if (axis.choices.empty()) problems_.add(value.position, fmt::format("'{}' has no values", name));
            axes.push_back(std::move(axis));
        }
        return axes;
    }

    // "stage.param=1,2,3" of the command line.
    std::vector<Axis> parse_axes(const std::string& flag, const std::vector<std::string>& arguments)
    {
        std::vector<Axis> axes;
        for (const auto& argument : arguments) {
            const std::size_t equals = argument.find('=');
            const auto at = [&](std::size_t i) { return argument_position(flag, argument, static_cast<int>(i) + 1); };
            if (equals == std::string::npos || equals + 1 == argument.size()) {
                problems_.add(at(0), "expected stage.param=VALUE,VALUE,...");
                continue;
            }
            Axis axis{argument.substr(0, equals), {}};
            for (std::size_t begin = equals + 1; begin <= argument.size();) {
                const std::size_t end = std::min(argument.find(',', begin), argument.size());
                axis.choices.push_back(
                    {axis.name, argument.substr(begin, end - begin), at(0), at(begin), fs::current_path()});
                begin = end + 1;
            }
            axes.push_back(std::move(axis));
        }
        return axes;
    }

    const Pipeline& pipeline() const { return pipeline_; }
    Problems& problems() { return problems_; }

private:
    void apply_configs(Pipeline& over, const YamlNode& names, const fs::path& folder)
    {
        for (const YamlNode* name : scalars(names, "'config'", problems_)) {
            try {
                const fs::path beside = folder / name->text;
                apply_config(over, fs::is_regular_file(beside) ? beside : find_yaml("configs", name->text), problems_);
            } catch (const UsageError& error) {
                problems_.add(name->position, error.what());
            }
        }
    }

    void apply_overlay(Pipeline& over, const YamlNode& map, const fs::path& folder, const std::string& what)
    {
        if (!expect_map(map, what, problems_)) return;
        for (const auto& entry : map.entries) {
            if (entry.key == "remove") {
                for (const YamlNode* name : scalars(entry.value, "'remove'", problems_)) {
                    if (!over.find(name->text))
                        problems_.add(name->position, fmt::format("the pipeline has no stage '{}'{}", name->text,
                                                                  hint(name->text, over.stage_names())));
                    over.remove(name->text);
                }
            } else if (entry.key == "config") {
                apply_configs(over, entry.value, folder);
            } else if (entry.key.find('.') != std::string::npos && entry.value.is_scalar()) {
                apply(over, {entry.key, entry.value.text, entry.position, entry.value.position, folder});
            } else {
                YamlNode one{YamlNode::Kind::Map, entry.position, {}, {}, {entry}};
                apply_stages(over, one, folder, problems_);
            }
        }
    }

    const Pipeline& pipeline_;
    Problems& problems_;
    std::vector<NamedSection> described_;
};

// "stage.param=value,stage.param=value" as a name for a folder.
std::string name_of(const std::vector<Choice>& choices)
{
    std::string name;
    for (const auto& choice : choices) {
        if (!name.empty()) name += ',';
        name += choice.axis == kVariantAxis ? choice.value : choice.axis + "=" + choice.value;
    }
    std::ranges::replace(name, '/', '_');
    return name;
}

bool holds(const std::vector<Choice>& combination, const std::vector<Choice>& choices)
{
    return std::ranges::all_of(choices, [&](const Choice& wanted) {
        return std::ranges::any_of(combination, [&](const Choice& choice) {
            return choice.axis == wanted.axis && choice.value == wanted.value;
        });
    });
}

std::vector<std::vector<Choice>> product(const std::vector<Axis>& axes)
{
    std::vector<std::vector<Choice>> combinations{{}};
    for (const auto& axis : axes) {
        std::vector<std::vector<Choice>> longer;
        for (const auto& combination : combinations)
            for (const auto& choice : axis.choices) {
                longer.push_back(combination);
                longer.back().push_back(choice);
            }
        combinations = std::move(longer);
    }
    return axes.empty() ? std::vector<std::vector<Choice>>() : combinations;
}

// Collects variants under unique names.
class Collector {
public:
    Collector(Maker& maker, Pipeline baseline) : maker_(maker), baseline_(std::move(baseline))
    {
        study.variants.push_back({kBaseline, baseline_});
    }

    void add(const std::vector<Choice>& choices)
    {
        Pipeline variant = baseline_;
        for (const auto& choice : choices)
            maker_.apply(variant, choice);
        const std::string name = name_of(choices);
        const bool is_new = std::ranges::find(study.variants, name, &Variant::name) == study.variants.end();
        if (is_new) study.variants.push_back({name, std::move(variant)});
    }

    Study study;

private:
    Maker& maker_;
    Pipeline baseline_;
};

void add_matrix(Maker& maker, Collector& collector)
{
    const StudySection* section = find_section(maker.pipeline(), "matrix");
    if (!section) return;
    auto combinations = product(maker.read_axes(section->value, section->folder, "'matrix'"));
    const auto each_of = [&](const char* key, const auto& take) {
        const YamlNode* list = find(section->value, key);
        if (!list) return;
        if (list->kind != YamlNode::Kind::List)
            maker.problems().add(list->position, fmt::format("'{}' is expected to be a list of maps", key));
        for (const auto& item : list->items)
            take(item, maker.read_choices(item, section->folder, fmt::format("an item of '{}'", key)));
    };
    each_of("exclude", [&](const YamlNode& item, const std::vector<Choice>& choices) {
        if (std::erase_if(combinations, [&](const auto& combination) { return holds(combination, choices); }) == 0)
            maker.problems().add(item.position, "excludes no combination of the matrix");
    });
    each_of("include",
            [&](const YamlNode&, std::vector<Choice> choices) { combinations.push_back(std::move(choices)); });
    for (const auto& combination : combinations)
        collector.add(combination);
}

void add_one_at_a_time(const std::vector<Axis>& axes, Collector& collector)
{
    for (const auto& axis : axes)
        for (const auto& choice : axis.choices)
            collector.add({choice});
}

std::vector<std::string> read_metrics(const Pipeline& pipeline, Problems& problems)
{
    std::vector<std::string> patterns;
    const StudySection* section = find_section(pipeline, "report");
    if (!section || !expect_map(section->value, "'report'", problems)) return patterns;
    refuse_unknown_keys(section->value, {"metrics"}, "a report", problems);
    if (const YamlNode* metrics = find(section->value, "metrics"))
        for (const YamlNode* pattern : scalars(*metrics, "'metrics'", problems))
            patterns.push_back(pattern->text);
    return patterns;
}

// Leaves the baseline and the variants that were asked for.
void keep_only(Study& study, const std::vector<std::string>& only, Problems& problems)
{
    if (only.empty()) return;
    std::vector<std::string> names;
    for (const auto& variant : study.variants)
        names.push_back(variant.name);
    for (const auto& name : only)
        if (std::ranges::find(names, name) == names.end())
            problems.add(argument_position("--only", name),
                         fmt::format("there is no variant '{}'{}", name, hint(name, names)));
    std::erase_if(study.variants, [&](const Variant& variant) {
        return variant.name != kBaseline && std::ranges::find(only, variant.name) == only.end();
    });
}

} // namespace

Study make_study(const Pipeline& pipeline, const StudyArguments& arguments, Problems& problems)
{
    Maker maker(pipeline, problems);
    Pipeline baseline = pipeline;
    std::vector<Axis> axes;
    if (const StudySection* ablate = find_section(pipeline, "ablate");
        ablate && expect_map(ablate->value, "'ablate'", problems)) {
        refuse_unknown_keys(ablate->value, {"baseline", "one_at_a_time"}, "'ablate'", problems);
        if (const YamlNode* choices = find(ablate->value, "baseline"))
            for (const auto& choice : maker.read_choices(*choices, ablate->folder, "'baseline'"))
                maker.apply(baseline, choice);
        if (const YamlNode* map = find(ablate->value, "one_at_a_time"))
            axes = maker.read_axes(*map, ablate->folder, "'one_at_a_time'");
    }
    Collector collector(maker, std::move(baseline));
    if (std::ranges::find(axes, kVariantAxis, &Axis::name) == axes.end())
        for (const auto& name : maker.described_names())
            collector.add({{kVariantAxis, name, {}, {}, {}}});
    add_one_at_a_time(axes, collector);
    add_matrix(maker, collector);
    add_one_at_a_time(maker.parse_axes("--vary", arguments.vary), collector);
    for (const auto& combination : product(maker.parse_axes("--matrix", arguments.matrix)))
        collector.add(combination);
    collector.study.metrics = read_metrics(pipeline, problems);
    keep_only(collector.study, arguments.only, problems);
    return std::move(collector.study);
}

Pipeline make_variant(const Pipeline& pipeline, const std::string& name, Problems& problems)
{
    Pipeline variant = pipeline;
    Maker(pipeline, problems).apply_variant(variant, name, argument_position("--variant", name));
    return variant;
}

} // namespace quoin
