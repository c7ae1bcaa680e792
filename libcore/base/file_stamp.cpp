#include "base/file_stamp.h"

#include <algorithm>
#include <ctime>
#include <sys/stat.h>

namespace quoin {
namespace {

constexpr std::int64_t kRacyWindow = 2'000'000'000; // [ns]; FAT keeps two seconds, nothing keeps less

std::int64_t nanoseconds(const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; }

} // namespace

std::optional<FileStamp> file_stamp(const std::filesystem::path& path)
{
    struct stat s {};
    if (::stat(path.c_str(), &s) != 0) return std::nullopt;
    return FileStamp{s.st_dev, s.st_ino, static_cast<std::uint64_t>(s.st_size), nanoseconds(s.st_mtim),
                     nanoseconds(s.st_ctim)};
}

std::string to_text(const FileStamp& s)
{
    std::string text;
    for (const std::uint64_t value : {s.device, s.inode, s.size})
        text += std::to_string(value) + ' ';
    return text + std::to_string(s.modified_ns) + ' ' + std::to_string(s.changed_ns);
}

std::int64_t now_ns()
{
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    return nanoseconds(t);
}

bool is_racy(const FileStamp& stamp, std::int64_t read_ns)
{
    return std::max(stamp.modified_ns, stamp.changed_ns) + kRacyWindow >= read_ns;
}

} // namespace quoin
