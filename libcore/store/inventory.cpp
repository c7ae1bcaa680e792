#include "store/inventory.h"

#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "store/lease.h"
#include "store/object.h"
#include "store/run_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

// The files two levels below a folder of the store: ac/ab/<key>.json, cas/cd/<payload>.
std::vector<fs::path> paths_in(const fs::path& folder)
{
    std::vector<fs::path> paths;
    std::error_code error;
    for (const auto& shelf : fs::directory_iterator(folder, error))
        for (const auto& entry : fs::directory_iterator(shelf.path(), error))
            paths.push_back(entry.path());
    std::ranges::sort(paths);
    return paths;
}

InventoryEntry read_inventory_entry(const fs::path& path)
{
    InventoryEntry item;
    item.key = path.stem().string();
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) item.used = status.st_mtim.tv_sec;
    std::optional<StoreEntry> entry;
    try {
        entry = parse_entry(read_text(path));
    } catch (const Error&) { // another gc was faster
    }
    item.is_damaged = !entry || sha256_hex(entry->key_json) != item.key;
    if (item.is_damaged) return item;
    item.stage = nlohmann::json::parse(entry->key_json).value("stage", "");
    item.entry = std::move(*entry);
    return item;
}

bool is_linked(const fs::path& object)
{
    struct stat status {};
    if (!fs::is_directory(object)) return ::stat(object.c_str(), &status) == 0 && status.st_nlink > 1;
    std::error_code error;
    for (const auto& file : fs::recursive_directory_iterator(object, error))
        if (file.is_regular_file(error) && file.hard_link_count(error) > 1) return true;
    return false;
}

} // namespace

std::vector<InventoryEntry> inventory_entries(const Store& store)
{
    const auto paths = paths_in(store.root() / "ac");
    std::vector<InventoryEntry> entries(paths.size());
    parallel_for(paths.size(), [&](std::size_t i) { entries[i] = read_inventory_entry(paths[i]); });
    return entries;
}

std::vector<InventoryObject> inventory_objects(const Store& store)
{
    std::vector<InventoryObject> objects;
    for (const auto& path : paths_in(store.root() / "cas"))
        objects.push_back({path.filename().string(), object_size(path).value_or(0), is_linked(path)});
    return objects;
}

std::set<std::string> names_in_use(const Store& store)
{
    std::set<std::string> names;
    std::error_code error;
    for (const auto& lease : fs::directory_iterator(store.root() / "lease", error)) {
        if (!is_held(lease.path())) continue;
        names.insert(lease.path().filename().string());
        for (auto& payload : lines_of(lease.path()))
            names.insert(std::move(payload));
    }
    for (const auto& run : run_files(store))
        if (is_held(run)) names.merge(names_in(read_run_file(run)));
    return names;
}

} // namespace quoin
