#include "store/store.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

void make_folder(const fs::path& folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw InputError(
            fmt::format("{}: cannot make the folder: {}; choose another place with --store or $QUOIN_STORE",
                        folder.string(), error.message()));
}

void link_file(const fs::path& object, const fs::path& place)
{
    const TemporaryPath temporary(place);
    if (::link(object.c_str(), temporary.path().c_str()) != 0) {
        std::error_code error;
        fs::create_symlink(fs::absolute(object), temporary.path(), error);
        if (error) fs::copy_file(object, temporary.path(), error);
        if (error) throw InputError(fmt::format("{}: cannot write: {}", place.string(), error.message()));
    }
    // Two links of one file: rename() leaves both and says it succeeded; the temporary one is removed with its guard.
    if (::rename(temporary.path().c_str(), place.c_str()) != 0)
        throw InputError(fmt::format("{}: cannot write: {}", place.string(), std::strerror(errno)));
}

void link_folder(const fs::path& object, const fs::path& place)
{
    write_folder_atomically(place, [&](const fs::path& temporary) {
        for (const auto& entry : fs::recursive_directory_iterator(object)) {
            const fs::path target = temporary / entry.path().lexically_relative(object);
            if (entry.is_directory())
                fs::create_directory(target);
            else
                link_file(entry.path(), target);
        }
    });
}

void make_read_only(const fs::path& path)
{
    constexpr auto readable = fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read;
    if (!fs::is_directory(path)) return fs::permissions(path, readable);
    for (const auto& entry : fs::recursive_directory_iterator(path))
        if (entry.is_regular_file()) fs::permissions(entry.path(), readable);
}

} // namespace

Store::Store(fs::path root) : root_(std::move(root) / "v1")
{
    for (const char* folder : {"ac", "cas", "tmp", "lease", "stat"})
        make_folder(root_ / folder);
}

fs::path Store::entry_path(const Key& key) const { return root_ / "ac" / key.hex.substr(0, 2) / (key.hex + ".json"); }
fs::path Store::object(const std::string& payload) const { return root_ / "cas" / payload.substr(0, 2) / payload; }
fs::path Store::temporary_place(const std::string& name) const { return root_ / "tmp" / name; }
fs::path Store::stat_cache() const { return root_ / "stat"; }

std::optional<StoreEntry> Store::find(const Key& key) const
{
    const fs::path path = entry_path(key);
    std::error_code missing;
    if (!fs::exists(path, missing)) return std::nullopt;
    const Json json = Json::parse(read_text(path), nullptr, false);
    if (json.is_discarded() || !json.contains("outputs") || !json["outputs"].is_object()) {
        log_warning(fmt::format("{}: the store's entry is damaged; computing it again", path.string()));
        fs::remove(path, missing);
        return std::nullopt;
    }
    StoreEntry entry;
    for (const auto& [port, payload] : json["outputs"].items()) {
        entry.outputs[port] = payload.get<std::string>();
        if (!fs::exists(object(entry.outputs[port]), missing)) return std::nullopt;
    }
    entry.record_json = json.value("record", Json::object()).dump();
    return entry;
}

void Store::adopt(const fs::path& finished, const std::string& payload) const
{
    const fs::path place = object(payload);
    make_folder(place.parent_path());
    make_read_only(finished);
    std::error_code error;
    if (fs::exists(place, error)) return;
    fs::rename(finished, place, error);
    if (error && !fs::exists(place))
        throw ResourceError(fmt::format("{}: cannot write: {}", place.string(), error.message()));
}

void Store::publish(const Key& key, const StoreEntry& entry) const
{
    const fs::path path = entry_path(key);
    make_folder(path.parent_path());
    const Json json = {
        {"key", Json::parse(key.json)}, {"outputs", entry.outputs}, {"record", Json::parse(entry.record_json)}};
    const TemporaryPath temporary(temporary_place(key.hex));
    write_atomically(temporary.path(), json.dump(1) + "\n");
    if (::link(temporary.path().c_str(), path.c_str()) == 0) return;
    const auto other = find(key);
    if (!other) { // damaged or left without its objects: ours takes its place
        fs::rename(temporary.path(), path);
        return;
    }
    for (const auto& [port, payload] : entry.outputs) {
        const auto theirs = other->outputs.find(port);
        if (theirs == other->outputs.end() || theirs->second == payload) continue;
        throw ImpossibleError(fmt::format(
            "output '{}' of key {} differs from what another run computed ({} and {}): the stage is not deterministic; "
            "compare both with `quoin inspect`",
            port, key.hex, payload, theirs->second));
    }
}

void Store::link(const std::string& payload, const fs::path& place) const
{
    if (place.has_parent_path()) make_folder(place.parent_path());
    const fs::path source = object(payload);
    if (fs::is_directory(source))
        link_folder(source, place);
    else
        link_file(source, place);
}

Store::Lease::Lease(const Store& store, const Key& key)
{
    const fs::path path = store.root_ / "lease" / key.hex;
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) return; // a read-only store still serves
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    log_info("another process computes the same result; waiting for it");
    while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
    }
}

Store::Lease::~Lease()
{
    if (descriptor_ >= 0) ::close(descriptor_);
}

} // namespace quoin
