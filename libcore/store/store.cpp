#include "store/store.h"

#include "artifact/container.h"
#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "base/fail_point.h"
#include "base/log.h"
#include "store/clash.h"
#include "store/object.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDay = 86'400; // [s]

void make_folder(const fs::path& folder)
{
    std::error_code error;
    if (!fs::create_directories(folder, error) && !error) return;
    if (error)
        fail_writing(folder, "cannot make the folder", error.value(),
                     "choose another place with --store or $QUOIN_STORE");
    sync_folder(folder.parent_path());
}

void make_read_only(const fs::path& path)
{
    constexpr auto readable = fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read;
    if (!fs::is_directory(path)) return fs::permissions(path, readable);
    for (const auto& entry : fs::recursive_directory_iterator(path))
        if (entry.is_regular_file()) fs::permissions(entry.path(), readable);
}

// The text of a file, or none when it is not there: most keys that are asked for are.
std::optional<std::string> read_if_there(const fs::path& path)
{
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return std::nullopt;
    std::string text;
    char buffer[16384];
    for (ssize_t n = 0; (n = ::read(descriptor, buffer, sizeof(buffer))) > 0;)
        text.append(buffer, static_cast<std::size_t>(n));
    ::close(descriptor);
    return text;
}

// The time of an entry says when it was last used; touched at most once a day.
void mark_used(const fs::path& entry)
{
    struct stat status {};
    if (::stat(entry.c_str(), &status) != 0) return;
    const std::int64_t age = ::time(nullptr) - status.st_mtim.tv_sec;
    if (age > kDay || age < -kDay) ::utimensat(AT_FDCWD, entry.c_str(), nullptr, 0); // the store may be read-only
}

// Why the object cannot be served, as far as its size tells; "" when it can.
std::string visible_damage(const fs::path& object, std::uint64_t expected)
{
    const auto size = object_size(object);
    if (!size) return "is missing";
    // Equal payloads with other provenance may differ in length.
    if (*size == expected || is_complete_artifact(object)) return {};
    return fmt::format("has {} bytes instead of {}", *size, expected);
}

} // namespace

Store::Store(const fs::path& root) : root_(root / "v1")
{
    std::error_code error;
    if (fs::is_directory(root_ / "cas", error) && !is_writable()) return;
    for (const char* folder : {"ac", "cas", "tmp", "lease", "stat", "runs", "roots", "clash"})
        make_folder(root_ / folder);
}

bool Store::is_writable() const { return ::access((root_ / "cas").c_str(), W_OK) == 0; }

fs::path Store::entry(const std::string& key_hex) const
{
    return root_ / "ac" / key_hex.substr(0, 2) / (key_hex + ".json");
}
fs::path Store::object(const std::string& payload) const { return root_ / "cas" / payload.substr(0, 2) / payload; }
fs::path Store::lease(const std::string& key_hex) const { return root_ / "lease" / key_hex; }
fs::path Store::temporary_place(const std::string& name) const { return root_ / "tmp" / name; }
fs::path Store::stat_cache() const { return root_ / "stat"; }

std::optional<StoreEntry> Store::find(const Key& key) const
{
    const fs::path path = entry(key.hex);
    const auto text = read_if_there(path);
    if (!text) return std::nullopt;
    auto found = parse_entry(*text);
    if (!found || found->key_json != key.json) {
        log_warning(fmt::format("{}: the store's entry is damaged; computing it again", path.string()));
        ::unlink(path.c_str());
        return std::nullopt;
    }
    for (const auto& [port, payload] : found->outputs) {
        const std::string damage = visible_damage(object(payload), found->sizes[port]);
        if (damage.empty()) continue;
        log_warning(
            fmt::format("{}: output '{}' in the store {}; computing it again", object(payload).string(), port, damage));
        ::unlink(path.c_str()); // said once
        return std::nullopt;
    }
    mark_used(path);
    return found;
}

std::uint64_t Store::adopt(const fs::path& finished, const std::string& payload) const
{
    const fs::path place = object(payload);
    make_folder(place.parent_path());
    make_read_only(finished);
    fail_point("object_written", place);
    if (!rename_no_replace(finished, place) && !object_damage(place, payload).empty()) {
        const TemporaryPath damaged(temporary_place(payload));
        if (::rename(place.c_str(), damaged.path().c_str()) != 0) fail_writing(place, "cannot write", errno);
        rename_no_replace(finished, place);
    }
    sync_folder(place.parent_path());
    fail_point("object_published", place);
    const auto size = object_size(place);
    if (!size) fail_writing(place, "has vanished from the store", ENOENT);
    return *size;
}

void Store::publish(const Key& key, const StoreEntry& published) const
{
    const fs::path path = entry(key.hex);
    make_folder(path.parent_path());
    const TemporaryPath temporary(temporary_place(key.hex));
    write_synced(temporary.path(), entry_text(key, published));
    fail_point("entry_written", path);
    if (!rename_no_replace(temporary.path(), path)) {
        const auto theirs = find(key);
        if (theirs) return refuse_clash(*this, key, published, *theirs);
        // damaged or left without its objects: ours takes its place
        if (::rename(temporary.path().c_str(), path.c_str()) != 0) fail_writing(path, "cannot write", errno);
    }
    sync_folder(path.parent_path());
    fail_point("entry_published", path);
}

bool Store::link(const std::string& payload, const fs::path& place, const std::vector<std::string>& rewritten) const
{
    const fs::path source = object(payload);
    std::error_code error;
    if (!fs::exists(source, error)) return false;
    if (shows_object(source, place, rewritten)) return true;
    if (place.has_parent_path()) make_folder(place.parent_path());
    remove_abandoned_files(fs::absolute(place).parent_path());
    if (fs::is_directory(source))
        show_folder(source, place);
    else
        show_file(source, place, temporary_place(payload));
    return true;
}

bool Store::disown_if_damaged(const std::string& payload) const
{
    const fs::path place = object(payload);
    std::error_code error;
    if (!fs::exists(place, error) || object_damage(place, payload).empty()) return false;
    log_warning(fmt::format("{}: {}; taken out of the store", place.string(), object_damage(place, payload)));
    return fs::remove_all(place, error) > 0;
}

} // namespace quoin
