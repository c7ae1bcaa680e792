// What the store needs of files beyond atomic_file.h: when they are on the disk, and what killed processes leave.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

namespace quoin {

// Writes a file in place and syncs it: for one that is temporary itself.
void write_synced(const std::filesystem::path& path, std::string_view text);

// Until all that was written to it is on the disk; a folder's content is its names.
void sync_file(const std::filesystem::path& path);
void sync_folder(const std::filesystem::path& path);

// Replaces a file whole, but unsynced: for what can be made again after a power failure (records, caches). A file that
// has this content already is only dated anew.
void replace_file(const std::filesystem::path& path, std::string_view text);

// As write_folder_atomically, but unsynced: for links into the store.
void replace_folder(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

// Temporaries (.NAME.HOST.PID.RANDOM.tmp) in `folder` whose process is gone: those of this machine, and those of others
// not touched since `foreign_before` [s, the file system's time].
std::vector<std::filesystem::path> abandoned_files(const std::filesystem::path& folder, std::int64_t foreign_before);

// Removes temporaries that processes of this machine left in `folder` when they were killed: those for a file called
// `name`, or all. Returns how many.
std::size_t remove_abandoned_files(const std::filesystem::path& folder, std::string_view name = {}) noexcept;

// Throws what a system call's error means to a user: ResourceError for a full or failing disk, InputError otherwise.
[[noreturn]] void fail_writing(const std::filesystem::path& path, const char* doing, int error,
                               const char* what_to_do = nullptr);

} // namespace quoin
