#include "store/object.h"

#include "artifact/container.h"
#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "store/manifest.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

bool is_same_file(const fs::path& a, const fs::path& b)
{
    struct stat first {
    }, second{};
    return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

// A copy that shares its blocks, where the file system can (btrfs, XFS): nothing done to it touches the store.
bool clone_file(const fs::path& object, const fs::path& place)
{
    const int source = ::open(object.c_str(), O_RDONLY | O_CLOEXEC);
    if (source < 0) return false;
    const int target = ::open(place.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0444);
    const bool is_cloned = target >= 0 && ::ioctl(target, FICLONE, source) == 0;
    ::close(source);
    if (target >= 0) ::close(target);
    if (target >= 0 && !is_cloned) ::unlink(place.c_str());
    return is_cloned;
}

// A relative link: it survives when store and results move together.
void symlink_or_copy(const fs::path& object, const fs::path& place)
{
    std::error_code error;
    const fs::path folder = fs::weakly_canonical(fs::absolute(place).parent_path());
    fs::create_symlink(fs::canonical(object).lexically_relative(folder), place, error);
    if (!error) return;
    fs::copy_file(object, place, fs::copy_options::overwrite_existing, error);
    if (error) fail_writing(place, "cannot write", error.value());
}

// At a temporary place, where nothing is.
bool clone_or_link(const fs::path& object, const fs::path& place)
{
    return clone_file(object, place) || ::link(object.c_str(), place.c_str()) == 0;
}

} // namespace

std::optional<std::uint64_t> object_size(const fs::path& object)
{
    struct stat status {};
    if (::stat(object.c_str(), &status) != 0) return std::nullopt;
    if (!S_ISDIR(status.st_mode)) return static_cast<std::uint64_t>(status.st_size);
    std::uint64_t size = 0;
    std::error_code error;
    for (auto it = fs::recursive_directory_iterator(object, error); !error && it != fs::recursive_directory_iterator();
         it.increment(error))
        if (it->is_regular_file(error)) size += it->file_size(error);
    return error ? std::nullopt : std::optional(size);
}

std::string object_damage(const fs::path& object, const std::string& payload)
{
    try {
        if (!fs::exists(object)) return "is missing";
        const std::string found =
            fs::is_directory(object) ? folder_digest(object, {}) : read_artifact(object).payload();
        return found == payload ? "" : fmt::format("its contents are those of {}", found);
    } catch (const Error& error) {
        return error.what();
    } catch (const fs::filesystem_error& error) {
        return error.what();
    }
}

bool rename_no_replace(const fs::path& from, const fs::path& place)
{
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, place.c_str(), RENAME_NOREPLACE) == 0) return true;
    if (errno == EEXIST) return false;
    if (errno != EINVAL && errno != ENOSYS) fail_writing(place, "cannot write", errno);
    if (fs::is_directory(from)) { // rename() itself refuses to replace a folder that is not empty
        if (::rename(from.c_str(), place.c_str()) == 0) return true;
        if (errno == ENOTEMPTY || errno == EEXIST) return false;
        fail_writing(place, "cannot write", errno);
    }
    if (::link(from.c_str(), place.c_str()) != 0) {
        if (errno == EEXIST) return false;
        fail_writing(place, "cannot write", errno);
    }
    ::unlink(from.c_str());
    return true;
}

bool shows_object(const fs::path& object, const fs::path& place, const std::vector<std::string>& rewritten)
{
    std::error_code error;
    if (!fs::is_directory(object, error)) return is_same_file(object, place);
    if (!fs::is_directory(place, error)) return false;
    for (auto it = fs::recursive_directory_iterator(object, error); !error && it != fs::recursive_directory_iterator();
         it.increment(error)) {
        const fs::path name = it->path().lexically_relative(object);
        const bool may_differ = std::ranges::find(rewritten, name.string()) != rewritten.end();
        const bool is_there = it->is_directory(error) || may_differ ? fs::exists(place / name, error)
                                                                    : is_same_file(it->path(), place / name);
        if (!is_there) return false;
    }
    return !error;
}

void show_file(const fs::path& object, const fs::path& place, const fs::path& temporary)
{
    const TemporaryPath beside_store(temporary);
    if (clone_or_link(object, beside_store.path()) && ::rename(beside_store.path().c_str(), place.c_str()) == 0) return;
    if (!fs::exists(object)) fail_writing(object, "cannot read", ENOENT);
    const TemporaryPath beside(place); // another file system, or a read-only store
    if (!clone_or_link(object, beside.path())) symlink_or_copy(object, beside.path());
    if (::rename(beside.path().c_str(), place.c_str()) != 0) fail_writing(place, "cannot write", errno);
}

void show_folder(const fs::path& object, const fs::path& place)
{
    replace_folder(place, [&](const fs::path& temporary) {
        for (const auto& entry : fs::recursive_directory_iterator(object)) {
            const fs::path target = temporary / entry.path().lexically_relative(object);
            if (entry.is_directory())
                fs::create_directory(target);
            else if (!clone_or_link(entry.path(), target))
                symlink_or_copy(entry.path(), target);
        }
    });
}

} // namespace quoin
