// What stages needed when they were last computed, from the records in the store.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace quoin {

struct StageCost {
    double seconds = 0.0;
    std::uint64_t peak_memory_bytes = 0;
};

// The largest figures of every stage, by the name that the stage gives itself. Damaged entries are passed over.
std::map<std::string, StageCost> recorded_costs(const std::filesystem::path& store);

} // namespace quoin
