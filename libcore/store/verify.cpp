#include "store/verify.h"

#include "base/parallel.h"
#include "store/inventory.h"
#include "store/object.h"

#include <fmt/format.h>
#include <map>

namespace quoin {
namespace fs = std::filesystem;
namespace {

// Who made an object, for messages: "output 'mesh' of fuse".
std::map<std::string, std::string> makers(const std::vector<InventoryEntry>& entries)
{
    std::map<std::string, std::string> makers;
    for (const auto& item : entries)
        for (const auto& [port, payload] : item.entry.outputs)
            makers.emplace(payload, fmt::format("output '{}' of {}", port, item.stage));
    return makers;
}

} // namespace

VerifyReport verify_store(const Store& store, bool take_out)
{
    VerifyReport report;
    const auto entries = inventory_entries(store);
    const auto objects = inventory_objects(store);
    auto made_by = makers(entries);
    std::vector<std::string> damage(objects.size());
    parallel_for(objects.size(), [&](std::size_t i) {
        damage[i] = object_damage(store.object(objects[i].payload), objects[i].payload);
    });
    for (std::size_t i = 0; i < objects.size(); ++i) {
        report.size += objects[i].size;
        const std::string& payload = objects[i].payload;
        const auto maker = made_by.extract(payload);
        if (damage[i].empty()) continue;
        report.damage.push_back(
            {fmt::format("{}, object {}", maker ? maker.mapped() : "output of an unknown stage", payload), damage[i]});
        if (take_out) store.disown_if_damaged(payload);
    }
    for (const auto& [payload, maker] : made_by) // those that had an object were taken out of the list
        report.damage.push_back({fmt::format("{}, object {}", maker, payload), "is missing"});
    for (const auto& item : entries) {
        if (!item.is_damaged) continue;
        report.damage.push_back({fmt::format("entry {}", item.key), "does not hold the key that it is named after"});
        std::error_code error;
        if (take_out) fs::remove(store.entry(item.key), error);
    }
    report.entries = entries.size();
    report.objects = objects.size();
    return report;
}

} // namespace quoin
