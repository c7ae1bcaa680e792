// Frees space in a store. What pins, the last runs and folders of results hold stays, and nothing that a process which
// runs now needs is touched; no lock stops anybody meanwhile.
#pragma once

#include "store/store.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

// Without any limit only rubbish goes: temporaries of processes that were killed, damaged entries, objects that no
// entry names.
struct GcOptions {
    std::optional<std::uint64_t> max_size; // [bytes]: the entries that were unused for longest go until the store fits
    std::optional<double> older_than;      // [s]: entries that were unused for longer go
    std::optional<int> keep_last;          // runs whose results stay; given alone: what no root holds goes
    bool is_dry = false;                   // only say what would go
};

struct GcItem {
    std::string what; // "entry ab12... (fuse)"
    std::string why;
    std::uint64_t size = 0; // [bytes] that go with it
};

struct GcReport {
    std::vector<GcItem> removed;
    std::vector<GcItem> kept; // entries, with the root that holds them
    std::uint64_t size_before = 0, size_after = 0;
};

GcReport collect_garbage(const Store& store, const GcOptions& options);

} // namespace quoin
