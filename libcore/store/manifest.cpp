#include "store/manifest.h"

#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <map>
#include <sstream>
#include <sys/stat.h>
#include <vector>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// What the file system says of a file; equal stamps mean equal content, but for the racy window below.
struct Stamp {
    std::uint64_t device = 0, inode = 0, size = 0;
    std::int64_t modified_ns = 0, changed_ns = 0;
    bool operator==(const Stamp&) const = default;
};

struct Known {
    Stamp stamp;
    std::int64_t hashed_ns = 0;
    std::string digest;
};

// A file changed this shortly before it was hashed may change again within the clock's granularity: it is hashed anew.
constexpr std::int64_t kRacyWindow = 2'000'000'000; // [ns]

std::int64_t nanoseconds(const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; }

std::int64_t now_ns()
{
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    return nanoseconds(t);
}

Stamp stamp_of(const fs::path& path)
{
    struct stat s {};
    if (::stat(path.c_str(), &s) != 0)
        throw InputError(fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
    return {s.st_dev, s.st_ino, static_cast<std::uint64_t>(s.st_size), nanoseconds(s.st_mtim), nanoseconds(s.st_ctim)};
}

std::vector<std::string> sorted_files(const fs::path& folder)
{
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw InputError(folder.string() + ": no such folder; name the folder of a scan");
    std::vector<std::string> names;
    auto it = fs::recursive_directory_iterator(folder, fs::directory_options::follow_directory_symlink, error);
    if (error) throw InputError(fmt::format("{}: cannot read: {}", folder.string(), error.message()));
    for (; it != fs::recursive_directory_iterator(); ++it) {
        if (it->path().filename().string().starts_with('.')) {
            it.disable_recursion_pending();
            continue;
        }
        if (it->is_regular_file()) names.push_back(it->path().lexically_relative(folder).generic_string());
    }
    std::ranges::sort(names);
    return names;
}

std::map<std::string, Known> read_stat_cache(const fs::path& file)
{
    std::map<std::string, Known> known;
    std::error_code missing;
    if (!fs::exists(file, missing)) return known;
    std::istringstream lines(read_text(file));
    Known k;
    std::string name;
    while (lines >> k.stamp.device >> k.stamp.inode >> k.stamp.size >> k.stamp.modified_ns >> k.stamp.changed_ns >>
               k.hashed_ns >> k.digest &&
           lines.get() && std::getline(lines, name))
        known.insert_or_assign(name, k);
    return known;
}

void write_stat_cache(const fs::path& file, const std::vector<std::string>& names, const std::vector<Known>& known)
{
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto& [s, hashed, digest] = known[i];
        text += fmt::format("{} {} {} {} {} {} {} {}\n", s.device, s.inode, s.size, s.modified_ns, s.changed_ns, hashed,
                            digest, names[i]);
    }
    fs::create_directories(file.parent_path());
    write_atomically(file, text);
}

} // namespace

std::string folder_digest(const fs::path& folder, const fs::path& cache_folder)
{
    const auto names = sorted_files(folder);
    const Stamp self = stamp_of(folder);
    const fs::path cache_file = cache_folder / fmt::format("{:x}-{:x}", self.device, self.inode);
    const auto cache = cache_folder.empty() ? std::map<std::string, Known>{} : read_stat_cache(cache_file);

    std::vector<Known> known(names.size());
    std::vector<std::uint8_t> hashed(names.size(), 0);
    parallel_for(names.size(), [&](std::size_t i) {
        const Stamp stamp = stamp_of(folder / names[i]);
        const auto it = cache.find(names[i]);
        const bool same =
            it != cache.end() && it->second.stamp == stamp && stamp.modified_ns + kRacyWindow < it->second.hashed_ns;
        if (same) {
            known[i] = it->second;
            return;
        }
        known[i] = {stamp, now_ns(), sha256_hex_of_file(folder / names[i])};
        hashed[i] = 1;
    });
    const bool changed = names.size() != cache.size() || std::ranges::find(hashed, 1) != hashed.end();
    if (changed && !cache_folder.empty()) write_stat_cache(cache_file, names, known);

    Sha256Stream digest;
    for (std::size_t i = 0; i < names.size(); ++i)
        digest.update(fmt::format("{}\n{}\n{}\n", names[i], known[i].stamp.size, known[i].digest));
    return to_hex(digest.finish());
}

} // namespace quoin
