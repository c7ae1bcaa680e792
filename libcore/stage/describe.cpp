#include "stage/describe.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson json_of(const ParamValue& value)
{
    return std::visit([](const auto& v) { return OrderedJson(v); }, value);
}

OrderedJson describe_param(const ParamSpec& spec)
{
    OrderedJson json = {{"name", spec.name},
                        {"type", type_name(spec.type)},
                        {"default", json_of(spec.default_value)},
                        {"unit", spec.unit},
                        {"doc", spec.doc}};
    if (std::isfinite(spec.min)) json["min"] = spec.min;
    if (std::isfinite(spec.max)) json["max"] = spec.max;
    if (!spec.choices.empty()) json["choices"] = spec.choices;
    json["affects_result"] = spec.flags.affects_result;
    if (spec.flags.has_neutral) json["neutral"] = json_of(spec.default_value);
    return json;
}

OrderedJson describe_ports(const std::vector<Port>& ports)
{
    OrderedJson list = OrderedJson::array();
    for (const auto& port : ports)
        list.push_back({{"port", port.name},
                        {"schema", port.schema_name()},
                        {"version", 1},
                        {"optional", port.optional},
                        {"doc", port.doc}});
    return list;
}

std::string range_of(const ParamSpec& spec)
{
    if (!spec.choices.empty()) return fmt::format("{}", fmt::join(spec.choices, " | "));
    std::string text{type_name(spec.type)};
    if (std::isfinite(spec.min) && std::isfinite(spec.max))
        text += fmt::format(" {}..{}", spec.min, spec.max);
    else if (std::isfinite(spec.min))
        text += fmt::format(" >= {}", spec.min);
    else if (std::isfinite(spec.max))
        text += fmt::format(" <= {}", spec.max);
    return spec.unit.empty() ? text : text + " [" + spec.unit + "]";
}

std::string ports_help(const char* title, const char* flag, const std::vector<Port>& ports)
{
    std::string text = fmt::format("\n{}\n", title);
    for (const auto& port : ports)
        text += fmt::format("  {} {}=PATH{}  {}\n", flag, port.name, port.optional ? " (optional)" : "", port.doc);
    return text;
}

} // namespace

std::string describe_json(const Stage& stage, const std::vector<ParamSpec>& params)
{
    OrderedJson list = OrderedJson::array();
    for (const auto& spec : params)
        list.push_back(describe_param(spec));
    const OrderedJson json = {
        {"name", stage.name},
        {"summary", stage.summary},
        {"impl", implementation_of(stage)},
        {"impl_version", stage.impl_version},
        {"inputs", describe_ports(stage.inputs)},
        {"outputs", describe_ports(stage.outputs)},
        {"reads_images", stage.reads_images},
        {"params", list},
        {"resources", {{"cores", stage.resources.cores}, {"memory", stage.resources.memory}}},
        {"deterministic", true},
        {"exit_codes",
         {{"0", "done, or found in the store"},
          {"2", "usage or configuration"},
          {"3", "bad input data"},
          {"4", "out of memory, disk or time"},
          {"5", "cannot succeed on this data"},
          {"75", "try again"},
          {"128+n", "ended by signal n"}}},
    };
    return json.dump(2);
}

std::string help_text(const Stage& stage, const std::vector<ParamSpec>& params)
{
    std::string text = fmt::format("{}: {}\n", stage.name, stage.summary);
    text += ports_help("inputs", "--in", stage.inputs) + ports_help("outputs", "--out", stage.outputs);
    text += "\nparameters, by --set NAME=VALUE or --config FILE.yaml\n";
    for (const auto& spec : params)
        text += fmt::format("  {:<26} {:<28} default {}\n      {}\n", spec.name, range_of(spec),
                            format_param(spec.default_value), spec.doc);
    text += "\noptions\n";
    if (stage.reads_images) text += "  --scan-root DIR        the folder that the scan's image files are in\n";
    text += "  --threads N            threads to use; 0 = all (the result does not depend on it)\n"
            "  --memory SIZE          limit, such as 4G or 500M\n"
            "  --cache auto|off|only  look into the store and fill it; leave it alone; never compute\n"
            "  --store DIR            the store (default: $QUOIN_STORE; without either, no store)\n"
            "  --progress auto|bar|json|none\n"
            "  --log-level debug|info|warning|error|off\n"
            "  --record FILE          write a JSON record of the run\n"
            "  --key                  print the cache key and its JSON, and do nothing else\n"
            "  --describe             print this description as JSON\n";
    return text;
}

} // namespace quoin
