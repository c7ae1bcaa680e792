// What the file system says of a file: equal stamps mean equal content, but for files changed just before they were
// read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace quoin {

struct FileStamp {
    std::uint64_t device = 0, inode = 0, size = 0;
    std::int64_t modified_ns = 0, changed_ns = 0;
    bool operator==(const FileStamp&) const = default;
};

std::optional<FileStamp> file_stamp(const std::filesystem::path& path); // none when there is no such file
std::string to_text(const FileStamp& stamp);                            // "device inode size modified changed"

std::int64_t now_ns(); // the wall clock

// True when the file was changed so shortly before `read_ns`, or after it, that it may change again within the clock's
// granularity without its stamp showing it: what was read then is not to be remembered.
bool is_racy(const FileStamp& stamp, std::int64_t read_ns);

} // namespace quoin
