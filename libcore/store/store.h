// The content store: key -> entry (payload digests) -> objects. An entry exists only when its objects are complete; it
// is published last. Objects are immutable files (or folders) named by their payload.
//
//     ROOT/v1/ac/ab/<key>.json   entry: the key's JSON, outputs, the run's record
//     ROOT/v1/cas/cd/<payload>   objects        ROOT/v1/tmp/   work in progress
//     ROOT/v1/lease/<key>        lock that only saves double work        ROOT/v1/stat/   stat caches of scan folders
#pragma once

#include "store/key.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace quoin {

struct StoreEntry {
    std::map<std::string, std::string> outputs; // port -> payload
    std::string record_json;                    // of the run that made them
};

class Store {
public:
    // Makes the folders. Throws InputError or ResourceError when it cannot.
    explicit Store(std::filesystem::path root);

    // The entry of a key, if it is there with all its objects.
    std::optional<StoreEntry> find(const Key& key) const;

    std::filesystem::path object(const std::string& payload) const;
    std::filesystem::path temporary_place(const std::string& name) const; // beside which a TemporaryPath may be made
    std::filesystem::path stat_cache() const;

    // Moves a finished file or folder into its object's place; keeps the one that is there already.
    void adopt(const std::filesystem::path& finished, const std::string& payload) const;

    // Publishes the entry. When another run published the same key with other payloads, keeps theirs and throws
    // ImpossibleError that names the ports: the stage is not deterministic.
    void publish(const Key& key, const StoreEntry& entry) const;

    // Makes `place` show the object: a hard link, else a symbolic link, else a copy (folders: file by file).
    void link(const std::string& payload, const std::filesystem::path& place) const;

    // Held while a key is computed; released by the kernel when the process ends, however it ends.
    class Lease {
    public:
        Lease(const Store& store, const Key& key);
        ~Lease();
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;

    private:
        int descriptor_ = -1;
    };

private:
    std::filesystem::path entry_path(const Key& key) const;
    std::filesystem::path root_;
};

} // namespace quoin
