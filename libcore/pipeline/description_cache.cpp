#include "pipeline/description_cache.h"

#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "base/file_stamp.h"

#include <cstdlib>
#include <fstream>

namespace quoin {
namespace fs = std::filesystem;
namespace {

bool is_compiled(const fs::path& program)
{
    char magic[4] = {};
    std::ifstream(program, std::ios::binary).read(magic, sizeof(magic));
    return std::string_view(magic, sizeof(magic)) == "\x7f"
                                                     "ELF";
}

} // namespace

DescriptionCache::DescriptionCache(fs::path folder) : folder_(std::move(folder)) {}

fs::path DescriptionCache::place(const fs::path& program) const
{
    constexpr std::size_t kName = 32; // digits of a digest that tell paths apart
    return folder_ / "describe" / sha256_hex(program.string()).substr(0, kName);
}

std::optional<std::string> DescriptionCache::find(const fs::path& program) const
{
    const auto stamp = file_stamp(program);
    std::error_code missing;
    if (folder_.empty() || !stamp || !fs::is_regular_file(place(program), missing)) return std::nullopt;
    try {
        const std::string text = read_text(place(program));
        const std::size_t line = text.find('\n');
        if (line == std::string::npos || text.substr(0, line) != to_text(*stamp)) return std::nullopt;
        return text.substr(line + 1);
    } catch (const Error&) {
        return std::nullopt;
    }
}

void DescriptionCache::remember(const fs::path& program, const std::string& description) const
{
    const auto stamp = file_stamp(program);
    if (folder_.empty() || !stamp || is_racy(*stamp, now_ns()) || !is_compiled(program)) return;
    std::error_code error;
    fs::create_directories(folder_ / "describe", error);
    if (error) return; // a home that cannot be written to: the programs are asked every time
    try {
        replace_file(place(program), to_text(*stamp) + "\n" + description);
    } catch (const Error&) {
    }
}

fs::path user_cache_folder()
{
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder == '/') return fs::path(folder) / "quoin";
    const char* home = std::getenv("HOME");
    return home && *home == '/' ? fs::path(home) / ".cache" / "quoin" : fs::path();
}

} // namespace quoin
