#include "store/entry.h"

#include <nlohmann/json.hpp>

namespace quoin {

using Json = nlohmann::json;

std::string entry_text(const Key& key, const StoreEntry& entry)
{
    Json outputs = Json::object();
    for (const auto& [port, payload] : entry.outputs)
        outputs[port] = {{"payload", payload}, {"size", entry.sizes.at(port)}};
    const Json json = {
        {"key", Json::parse(key.json)}, {"outputs", outputs}, {"record", Json::parse(entry.record_json)}};
    return json.dump(1) + "\n";
}

std::optional<StoreEntry> parse_entry(const std::string& text)
{
    try {
        const Json json = Json::parse(text);
        StoreEntry entry;
        for (const auto& [port, output] : json.at("outputs").items()) {
            entry.outputs[port] = output.at("payload").get<std::string>();
            entry.sizes[port] = output.at("size").get<std::uint64_t>();
        }
        entry.record_json = json.at("record").dump();
        entry.key_json = json.at("key").dump();
        return entry;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

std::string served_record(const StoreEntry& entry, const Key& key)
{
    Json record = Json::parse(entry.record_json);
    record["cached"] = true;
    record["key"] = key.hex;
    record["outputs"] = entry.outputs;
    return record.dump(2) + "\n";
}

} // namespace quoin
