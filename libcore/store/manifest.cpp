#include "store/manifest.h"

#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "base/file_stamp.h"
#include "base/log.h"
#include "base/parallel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <sstream>
#include <vector>

namespace quoin {
namespace {

namespace fs = std::filesystem;

struct Known {
    FileStamp stamp;
    std::int64_t hashed_ns = 0;
    std::string digest;
};

FileStamp stamp_of(const fs::path& path)
{
    const auto stamp = file_stamp(path);
    if (!stamp) throw InputError(fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
    return *stamp;
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
        text += fmt::format("{} {} {} {}\n", to_text(s), hashed, digest, names[i]);
    }
    try {
        fs::create_directories(file.parent_path());
        replace_file(file, text);
    } catch (const std::exception& error) { // a read-only store: everything is hashed again the next time
        log_debug(error.what());
    }
}

} // namespace

std::string folder_digest(const fs::path& folder, const fs::path& cache_folder)
{
    const auto names = sorted_files(folder);
    const FileStamp self = stamp_of(folder);
    const fs::path cache_file = cache_folder / fmt::format("{:x}-{:x}", self.device, self.inode);
    const auto cache = cache_folder.empty() ? std::map<std::string, Known>{} : read_stat_cache(cache_file);

    std::vector<Known> known(names.size());
    std::vector<std::uint8_t> hashed(names.size(), 0);
    parallel_for(names.size(), [&](std::size_t i) {
        const FileStamp stamp = stamp_of(folder / names[i]);
        const auto it = cache.find(names[i]);
        if (it != cache.end() && it->second.stamp == stamp && !is_racy(stamp, it->second.hashed_ns)) {
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
