// Everything that a store holds, for verify, gc and du.
#pragma once

#include "store/store.h"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace quoin {

struct InventoryEntry {
    std::string key;  // hexadecimal
    StoreEntry entry; // empty when it is damaged
    bool is_damaged = false;
    std::string stage;     // that made it
    std::int64_t used = 0; // [s], when it was last served, by the file system's clock
};

struct InventoryObject {
    std::string payload;
    std::uint64_t size = 0;
    bool is_linked = false; // a folder of results shares its file: removing it here frees nothing
};

// Sorted by key and by payload.
std::vector<InventoryEntry> inventory_entries(const Store& store);
std::vector<InventoryObject> inventory_objects(const Store& store);

// Payloads and keys that processes which run now need or make.
std::set<std::string> names_in_use(const Store& store);

} // namespace quoin
