// The content store: key -> entry (payload digests) -> objects. An entry exists only when its objects are complete; it
// is published last. Objects are immutable files (or folders) named by their payload. No file in it holds a path of its
// surroundings: a store that is moved or copied stays valid.
//
//     ROOT/v1/ac/ab/<key>.json   entry: the key's JSON, outputs, the run's record; its time says when it was last used
//     ROOT/v1/cas/cd/<payload>   objects                ROOT/v1/tmp/     work in progress
//     ROOT/v1/lease/<key>        who computes it now    ROOT/v1/stat/    stat caches of scan folders
//     ROOT/v1/runs/<run>.jsonl   what the driver ran    ROOT/v1/roots/   pins that gc keeps
//     ROOT/v1/clash/<key>/       both results, when two runs of one key differ
#pragma once

#include "store/entry.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

class Store {
public:
    // Makes the folders. Throws InputError or ResourceError when it cannot; a store that is there but read-only serves.
    explicit Store(const std::filesystem::path& root);

    const std::filesystem::path& root() const { return root_; } // ROOT/v1
    bool is_writable() const;

    // The entry of a key, if it is there with all its objects; says what is damaged or missing otherwise, and marks the
    // entry as used. Sizes are compared, contents are not: that is verify.h and the reader's checksums.
    std::optional<StoreEntry> find(const Key& key) const;

    std::filesystem::path entry(const std::string& key_hex) const;
    std::filesystem::path object(const std::string& payload) const;
    std::filesystem::path lease(const std::string& key_hex) const;
    std::filesystem::path temporary_place(const std::string& name) const; // beside which a TemporaryPath may be made
    std::filesystem::path stat_cache() const;

    // Moves a finished, synced file or folder into its object's place; keeps the one that is there already unless that
    // is damaged. Returns the object's size.
    std::uint64_t adopt(const std::filesystem::path& finished, const std::string& payload) const;

    // Publishes the entry. When another run published the same key with other payloads, theirs stays, both results are
    // kept under clash/, and ImpossibleError names the first difference: the stage is not deterministic.
    void publish(const Key& key, const StoreEntry& entry) const;

    // Makes `place` show the object: a clone or hard link, else a symbolic link, else a copy (folders: file by file).
    // Nothing is done when it does already; files called `rewritten` may differ, as their owner changes them
    // afterwards. False when the object has gone.
    bool link(const std::string& payload, const std::filesystem::path& place,
              const std::vector<std::string>& rewritten = {}) const;

    // Reads the object whole and takes it out of the store when it is damaged. True when it was.
    bool disown_if_damaged(const std::string& payload) const;

private:
    std::filesystem::path root_;
};

} // namespace quoin
