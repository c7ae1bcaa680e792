#include "store/gc.h"

#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "store/inventory.h"
#include "store/lease.h"
#include "store/object.h"
#include "store/pins.h"
#include "store/run_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <set>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr int kKeptRuns = 3;                   // whose results stay when nothing else is asked for
constexpr std::size_t kRunFiles = 100;         // that `quoin log` can show
constexpr double kForeignTemporary = 86'400.0; // [s], after which a temporary of another host is taken for abandoned

constexpr const char* kLinked = "a folder of results links it";

// The time by the file system's own clock: the machine's may have been set back, or differ from the server's.
std::int64_t file_system_time(const Store& store)
{
    const TemporaryPath probe(store.temporary_place("clock"));
    write_synced(probe.path(), "");
    struct stat status {};
    ::stat(probe.path().c_str(), &status);
    return status.st_mtim.tv_sec;
}

class Collector {
public:
    Collector(const Store& store, const GcOptions& options)
        : store_(store), options_(options), entries_(inventory_entries(store)), is_removed_(entries_.size(), false)
    {
        for (auto& object : inventory_objects(store))
            objects_.emplace(object.payload, std::move(object));
        for (const auto& [payload, object] : objects_)
            report_.size_before += object.size;
        report_.size_after = report_.size_before;
        now_ = file_system_time(store);
    }

    GcReport run()
    {
        find_roots();
        choose_damaged();
        choose_old();
        choose_largest_first_unused();
        report_kept();
        remove_entries();
        remove_objects();
        remove_leases_and_temporaries();
        remove_run_files();
        return std::move(report_);
    }

private:
    // Keys and payloads that stay, each with the reason that the user can act on.
    void find_roots()
    {
        const auto hold = [&](const std::set<std::string>& names, const std::string& why) {
            for (const auto& name : names)
                roots_.emplace(name, why);
        };
        hold(names_in_use(store_), "a run that goes on needs it");
        for (const auto& [name, held] : pins(store_))
            hold(held, fmt::format("pinned as '{}'", name));
        const auto runs = run_files(store_);
        const auto count = static_cast<std::size_t>(std::max(0, options_.keep_last.value_or(kKeptRuns)));
        for (std::size_t i = runs.size() - std::min(count, runs.size()); i < runs.size(); ++i)
            hold(names_in(read_run_file(runs[i])), fmt::format("run {} used it", runs[i].stem().string()));
        for (const auto& [payload, object] : objects_)
            if (object.is_linked) roots_.emplace(payload, kLinked);
    }

    // Why an entry stays whatever the limits say, or "".
    std::string root_of(const InventoryEntry& item) const
    {
        if (const auto root = roots_.find(item.key); root != roots_.end()) return root->second;
        for (const auto& [port, payload] : item.entry.outputs)
            if (const auto root = roots_.find(payload); root != roots_.end()) return root->second;
        return {};
    }

    bool is_incomplete(const InventoryEntry& item) const
    {
        return std::ranges::any_of(item.entry.outputs,
                                   [&](const auto& output) { return !objects_.contains(output.second); });
    }

    void remove(std::size_t i, std::string why)
    {
        is_removed_[i] = true;
        removed_now_[i] = std::move(why);
    }

    void choose_damaged()
    {
        for (std::size_t i = 0; i < entries_.size(); ++i) {
            if (entries_[i].is_damaged)
                remove(i, "the entry is damaged");
            else if (is_incomplete(entries_[i]))
                remove(i, "its objects are gone");
        }
    }

    bool may_remove(std::size_t i) const { return !is_removed_[i] && root_of(entries_[i]).empty(); }

    void choose_old()
    {
        const bool all = options_.keep_last && !options_.older_than && !options_.max_size;
        for (std::size_t i = 0; i < entries_.size(); ++i) {
            const auto unused = static_cast<double>(now_ - entries_[i].used);
            if (!may_remove(i)) continue;
            if (all)
                remove(i, "nothing holds it");
            else if (options_.older_than && unused > *options_.older_than)
                remove(i, fmt::format("unused for {:.1f} days", unused / 86'400.0));
        }
    }

    // Objects that some entry names, were these the entries that stay.
    std::set<std::string> referenced() const
    {
        std::set<std::string> payloads;
        for (std::size_t i = 0; i < entries_.size(); ++i)
            if (!is_removed_[i])
                for (const auto& [port, payload] : entries_[i].entry.outputs)
                    payloads.insert(payload);
        return payloads;
    }

    std::uint64_t referenced_size() const
    {
        std::uint64_t size = 0;
        for (const auto& payload : referenced())
            if (const auto object = objects_.find(payload); object != objects_.end()) size += object->second.size;
        return size;
    }

    void choose_largest_first_unused()
    {
        if (!options_.max_size) return;
        std::vector<std::size_t> order(entries_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t i) { return entries_[i].used; });
        std::uint64_t size = referenced_size();
        std::map<std::string, int> uses; // by payload: shared objects go with their last entry
        for (std::size_t i = 0; i < entries_.size(); ++i)
            if (!is_removed_[i])
                for (const auto& [port, payload] : entries_[i].entry.outputs)
                    ++uses[payload];
        for (const std::size_t i : order) {
            if (size <= *options_.max_size) return;
            if (!may_remove(i)) continue;
            remove(i, "the store is larger than --max-size; unused for longest");
            for (const auto& [port, payload] : entries_[i].entry.outputs)
                if (--uses[payload] == 0) size -= objects_.at(payload).size;
        }
    }

    std::string name_of(const InventoryEntry& item) const
    {
        return fmt::format("entry {:.12} ({})", item.key, item.stage.empty() ? "?" : item.stage);
    }

    void report_kept()
    {
        for (std::size_t i = 0; i < entries_.size(); ++i) {
            if (is_removed_[i]) continue;
            const std::string root = root_of(entries_[i]);
            std::uint64_t size = 0;
            for (const auto& [port, bytes] : entries_[i].entry.sizes)
                size += bytes;
            report_.kept.push_back({name_of(entries_[i]), root.empty() ? "within the limits" : root, size});
        }
    }

    // Entries go before their objects: whoever is killed in between leaves objects that the next gc removes.
    void remove_entries()
    {
        for (const auto& [i, why] : removed_now_) {
            report_.removed.push_back({name_of(entries_[i]), why, 0});
            if (!options_.is_dry) ::unlink(store_.entry(entries_[i].key).c_str());
        }
    }

    // Objects are first moved aside; those that a process began to need meanwhile are put back. It names what it needs
    // before it looks for it, so it either finds the object or is seen here.
    void remove_objects()
    {
        const std::set<std::string> needed = referenced();
        std::vector<std::string> doomed;
        for (const auto& [payload, object] : objects_)
            if (!needed.contains(payload) && !is_held_by_name(payload)) doomed.push_back(payload);
        if (options_.is_dry) return report_objects(doomed, {});
        const TemporaryPath aside(store_.temporary_place("gc"));
        fs::create_directory(aside.path());
        for (const auto& payload : doomed)
            if (::rename(store_.object(payload).c_str(), (aside.path() / payload).c_str()) != 0) continue;
        std::set<std::string> put_back;
        for (const auto& name : names_in_use(store_))
            if (fs::exists(aside.path() / name) && rename_no_replace(aside.path() / name, store_.object(name)))
                put_back.insert(name);
        report_objects(doomed, put_back);
    }

    // Results that folders link stay there; here they are of use only while an entry names them.
    bool is_held_by_name(const std::string& payload) const
    {
        const auto root = roots_.find(payload);
        return root != roots_.end() && root->second != kLinked;
    }

    void report_objects(const std::vector<std::string>& doomed, const std::set<std::string>& put_back)
    {
        for (const auto& payload : doomed) {
            if (put_back.contains(payload)) continue;
            const std::uint64_t size = objects_.at(payload).size;
            report_.removed.push_back({fmt::format("object {:.12}", payload), "no entry names it", size});
            report_.size_after -= size;
        }
    }

    void remove_path(const fs::path& path, const std::string& what, const std::string& why)
    {
        report_.removed.push_back({what, why, object_size(path).value_or(0)});
        std::error_code error;
        if (!options_.is_dry) fs::remove_all(path, error);
    }

    void remove_leases_and_temporaries()
    {
        std::error_code error;
        for (const auto& lease : fs::directory_iterator(store_.root() / "lease", error))
            if (!is_held(lease.path()))
                remove_path(lease.path(), fmt::format("lease {:.12}", lease.path().filename().string()),
                            "its process is gone");
        for (const auto& file :
             abandoned_files(store_.root() / "tmp", now_ - static_cast<std::int64_t>(kForeignTemporary)))
            remove_path(file, "temporary " + file.filename().string(), "its process is gone");
    }

    void remove_run_files()
    {
        const auto runs = run_files(store_);
        for (std::size_t i = 0; i + kRunFiles < runs.size(); ++i)
            if (!is_held(runs[i]))
                remove_path(runs[i], "log of run " + runs[i].stem().string(),
                            fmt::format("the last {} runs are kept", kRunFiles));
    }

    const Store& store_;
    const GcOptions& options_;
    std::vector<InventoryEntry> entries_;
    std::map<std::string, InventoryObject> objects_; // by payload
    std::map<std::string, std::string> roots_;       // key or payload -> why it stays
    std::vector<bool> is_removed_;
    std::map<std::size_t, std::string> removed_now_; // entry -> why
    std::int64_t now_ = 0;
    GcReport report_;
};

} // namespace

GcReport collect_garbage(const Store& store, const GcOptions& options)
{
    if (!store.is_writable() && !options.is_dry)
        throw InputError(store.root().string() + ": the store is read-only; only --dry-run works");
    return Collector(store, options).run();
}

} // namespace quoin
