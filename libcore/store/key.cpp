#include "store/key.h"

#include "artifact/digest.h"

#include <nlohmann/json.hpp>

namespace quoin {
namespace {

constexpr int kKeyVersion = 1;

nlohmann::json json_of(const ParamValues& params)
{
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [name, value] : params) {
        // Floats go in as text of std::to_chars: the shortest that reads back the same, whoever prints it.
        if (std::holds_alternative<double>(value))
            json[name] = {{"float", format_param(value)}};
        else
            std::visit([&](const auto& v) { json[name] = v; }, value);
    }
    return json;
}

} // namespace

std::string params_json(const ParamValues& params)
{
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [name, value] : params)
        std::visit([&](const auto& v) { json[name] = v; }, value);
    return json.dump();
}

Key make_key(const KeyParts& parts)
{
    nlohmann::json inputs = nlohmann::json::object();
    for (const auto& [port, input] : parts.inputs)
        inputs[port] = {{"schema", input.schema}, {"payload", "sha256:" + input.payload}};
    const nlohmann::json json = {
        {"kv", kKeyVersion},
        {"salt", ""},
        {"stage", parts.stage},
        {"impl", parts.implementation},
        {"impl_version", parts.impl_version},
        {"out", parts.outputs},
        {"params", json_of(parts.params)},
        {"in", inputs},
        {"env", nlohmann::json::object()},
    };
    Key key{json.dump(), {}};
    key.hex = sha256_hex(key.json);
    return key;
}

} // namespace quoin
