// Reads everything that a store holds and says what is damaged.
#pragma once

#include "store/store.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace quoin {

struct StoreDamage {
    std::string what;  // "output 'mesh' of fuse, object ab12...", or an entry
    std::string found; // "tensor 'position' is damaged"
};

struct VerifyReport {
    std::vector<StoreDamage> damage;
    std::size_t entries = 0, objects = 0;
    std::uint64_t size = 0; // [bytes] read
};

// Compares every entry's key with its name and every object's contents with its payload. With `take_out`, what is
// damaged leaves the store, so that the next run computes it again.
VerifyReport verify_store(const Store& store, bool take_out);

} // namespace quoin
