#include "pipeline/description.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using Json = nlohmann::json;

PortDescription parse_port(const Json& json)
{
    PortDescription port;
    port.name = json.at("port").get<std::string>();
    port.schema = json.value("schema", port.name);
    port.version = json.value("version", 1);
    port.optional = json.value("optional", false);
    port.doc = json.value("doc", "");
    return port;
}

ParamType parse_type(const std::string& name)
{
    for (const ParamType type :
         {ParamType::Bool, ParamType::Int, ParamType::Float, ParamType::String, ParamType::Choice})
        if (type_name(type) == name) return type;
    throw UsageError(fmt::format("a parameter of the unknown type '{}'", name));
}

ParamValue parse_default(const Json& json, ParamType type)
{
    switch (type) {
    case ParamType::Bool:
        return json.get<bool>();
    case ParamType::Int:
        return json.get<std::int64_t>();
    case ParamType::Float:
        return json.get<double>();
    case ParamType::String:
    case ParamType::Choice:
        return json.get<std::string>();
    }
    return {};
}

// An open end of an interval is absent or null.
double parse_bound(const Json& json, const char* key, double open)
{
    const auto it = json.find(key);
    return it == json.end() || !it->is_number() ? open : it->get<double>();
}

ParamSpec parse_param_spec(const Json& json)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    ParamSpec spec;
    spec.name = json.at("name").get<std::string>();
    spec.type = parse_type(json.at("type").get<std::string>());
    spec.default_value = parse_default(json.at("default"), spec.type);
    spec.unit = json.value("unit", "");
    spec.doc = json.value("doc", "");
    spec.min = parse_bound(json, "min", -infinity);
    spec.max = parse_bound(json, "max", infinity);
    if (const auto it = json.find("choices"); it != json.end() && it->is_array())
        spec.choices = it->get<std::vector<std::string>>();
    spec.flags.affects_result = json.value("affects_result", true);
    spec.flags.has_neutral = json.contains("neutral"); // it is the default
    return spec;
}

} // namespace

bool is_directory_schema(std::string_view schema) { return schema == "folder" || schema == "model"; }

const PortDescription* find_port(const std::vector<PortDescription>& ports, std::string_view name)
{
    const auto port = std::ranges::find(ports, name, &PortDescription::name);
    return port == ports.end() ? nullptr : &*port;
}

std::vector<std::string> port_names(const std::vector<PortDescription>& ports)
{
    std::vector<std::string> names;
    for (const auto& port : ports)
        names.push_back(port.name);
    return names;
}

StageDescription parse_description(const std::string& text, const std::string& who)
{
    try {
        const Json json = Json::parse(text);
        StageDescription stage;
        stage.name = json.at("name").get<std::string>();
        stage.summary = json.value("summary", "");
        stage.implementation = json.value("impl", "");
        stage.impl_version = json.value("impl_version", 1);
        for (const auto& port : json.at("inputs"))
            stage.inputs.push_back(parse_port(port));
        for (const auto& port : json.at("outputs"))
            stage.outputs.push_back(parse_port(port));
        for (const auto& param : json.at("params"))
            stage.params.push_back(parse_param_spec(param));
        stage.reads_images = json.value("reads_images", false);
        stage.code = json.value("code", stage.code);
        if (const Json resources = json.value("resources", Json::object()); resources.is_object()) {
            stage.cores = resources.value("cores", 0);
            stage.memory_formula = resources.value("memory", "");
        }
        return stage;
    } catch (const std::exception& error) {
        throw UsageError(fmt::format(
            "{}: what it says about itself (--describe) cannot be read: {}; is it a Quoin stage?", who, error.what()));
    }
}

} // namespace quoin
