#include "pipeline/key_difference.h"

#include <nlohmann/json.hpp>
#include <set>

namespace quoin {
namespace {

using Json = nlohmann::json;

Json member(const Json& json, const std::string& name)
{
    return json.is_object() && json.contains(name) ? json[name] : Json();
}

// Floats stand in the key as {"float": "0.2"}, inputs as {"schema": ..., "payload": ...}.
std::string text_of(const Json& value)
{
    if (value.is_null()) return {};
    if (value.is_string()) return value.get<std::string>();
    if (const Json number = member(value, "float"); number.is_string()) return number.get<std::string>();
    if (const Json payload = member(value, "payload"); payload.is_string()) return payload.get<std::string>();
    return value.dump();
}

void add_members(const Json& before, const Json& after, KeyChange::Kind kind, std::vector<KeyChange>& changes)
{
    std::set<std::string> names;
    for (const Json* json : {&before, &after})
        if (json->is_object())
            for (const auto& [name, value] : json->items())
                names.insert(name);
    for (const auto& name : names)
        if (const Json old_value = member(before, name), new_value = member(after, name); old_value != new_value)
            changes.push_back({kind, name, text_of(old_value), text_of(new_value)});
}

} // namespace

std::vector<KeyChange> key_difference(const std::string& before_text, const std::string& after_text)
{
    Json before = Json::parse(before_text, nullptr, false);
    Json after = Json::parse(after_text, nullptr, false);
    if (!before.is_object()) before = Json::object();
    if (!after.is_object()) after = Json::object();
    std::vector<KeyChange> changes;
    add_members(member(before, "params"), member(after, "params"), KeyChange::Kind::Param, changes);
    std::vector<KeyChange> inputs;
    add_members(member(before, "in"), member(after, "in"), KeyChange::Kind::Input, inputs);
    for (Json* json : {&before, &after}) {
        json->erase("params");
        json->erase("in");
    }
    add_members(before, after, KeyChange::Kind::Other, changes);
    changes.insert(changes.end(), inputs.begin(), inputs.end());
    return changes;
}

} // namespace quoin
