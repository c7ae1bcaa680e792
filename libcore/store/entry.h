// What the store knows of one key. An entry never changes once it is published.
#pragma once

#include "store/key.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace quoin {

struct StoreEntry {
    std::map<std::string, std::string> outputs;      // port -> payload
    std::string record_json = "{}";                  // of the run that made them
    std::map<std::string, std::uint64_t> sizes = {}; // port -> bytes of the object, of all files of a folder
    std::string key_json = {};                       // canonical; what `why` compares
};

// The text of an entry's file, and back. None when the text is damaged.
std::string entry_text(const Key& key, const StoreEntry& entry);
std::optional<StoreEntry> parse_entry(const std::string& text);

// The record of a run that was found in the store: the figures are those of the run that computed it.
std::string served_record(const StoreEntry& entry, const Key& key);

} // namespace quoin
