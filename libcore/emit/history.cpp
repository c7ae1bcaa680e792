#include "emit/history.h"

#include "base/atomic_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace quoin {
namespace fs = std::filesystem;

std::map<std::string, StageCost> recorded_costs(const fs::path& store)
{
    std::map<std::string, StageCost> costs;
    std::error_code missing;
    for (auto it = fs::recursive_directory_iterator(store / "v1" / "ac", missing);
         !missing && it != fs::recursive_directory_iterator(); it.increment(missing)) {
        if (it->path().extension() != ".json") continue;
        const auto entry = nlohmann::json::parse(read_text(it->path()), nullptr, false);
        if (!entry.is_object() || !entry.contains("record") || !entry["record"].is_object()) continue;
        const auto& record = entry["record"];
        const auto number = [&](const char* key) {
            return record.contains(key) && record[key].is_number() ? record[key].get<double>() : 0.0;
        };
        if (!record.contains("stage") || !record["stage"].is_string()) continue;
        StageCost& cost = costs[record["stage"].get<std::string>()];
        cost.seconds = std::max(cost.seconds, number("seconds"));
        cost.peak_memory_bytes =
            std::max(cost.peak_memory_bytes, static_cast<std::uint64_t>(number("peak_memory_bytes")));
    }
    return costs;
}

} // namespace quoin
