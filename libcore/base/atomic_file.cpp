#include "base/atomic_file.h"

#include "base/durable_file.h"
#include "base/error.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <limits>
#include <mutex>
#include <optional>
#include <random>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace quoin {
namespace fs = std::filesystem;
namespace {

std::mutex unfinished_mutex;
std::vector<fs::path> unfinished;

[[noreturn]] void fail(const fs::path& path, const char* doing, int error) { fail_writing(path, doing, error); }

// A name may hold dots; the fields behind it may not.
std::string host_name()
{
    char name[256] = "host";
    ::gethostname(name, sizeof(name) - 1);
    std::string text = name;
    std::ranges::replace(text, '.', '-');
    return text;
}

const std::string& this_host()
{
    static const std::string host = host_name();
    return host;
}

// NAME, HOST and PID of .NAME.HOST.PID.RANDOM.tmp
struct TemporaryName {
    std::string name, host;
    pid_t pid = 0;
};

std::optional<TemporaryName> parse_temporary(std::string text)
{
    std::array<std::string, 4> field; // PID at 2, HOST at 3: from the back
    for (auto& f : field) {
        const auto dot = text.rfind('.');
        if (dot == std::string::npos || dot == 0) return std::nullopt;
        f = text.substr(dot + 1);
        text.resize(dot);
    }
    TemporaryName parsed{text.substr(1), field[3], 0};
    const auto& pid = field[2];
    const auto [end, error] = std::from_chars(pid.data(), pid.data() + pid.size(), parsed.pid);
    const bool is_one =
        field[0] == "tmp" && text.front() == '.' && error == std::errc() && end == pid.data() + pid.size();
    return is_one ? std::optional(parsed) : std::nullopt;
}

// Has the process ended, or only not been waited for yet? A zombie still takes signals.
bool is_gone(pid_t pid)
{
    if (::kill(pid, 0) != 0) return errno == ESRCH;
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat"); // PID (NAME) STATE ...
    std::string line;
    if (!std::getline(file, line)) return false;
    const auto name_end = line.rfind(')');
    return name_end != std::string::npos && name_end + 2 < line.size() && line[name_end + 2] == 'Z';
}

bool is_abandoned(const TemporaryName& temporary, const fs::path& path, std::int64_t foreign_before)
{
    if (temporary.host == this_host()) return is_gone(temporary.pid);
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 && status.st_mtim.tv_sec < foreign_before;
}

// A temporary may be written by way of a temporary of its own.
bool belongs_to(const TemporaryName& temporary, std::string_view name)
{
    return name.empty() || temporary.name == name || temporary.name.starts_with("." + std::string(name) + ".");
}

void sync_path(const fs::path& path, int flags)
{
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
    if (descriptor < 0) fail(path, "cannot open", errno);
    const int result = ::fsync(descriptor);
    const int error = errno;
    ::close(descriptor);
    if (result != 0 && error != EINVAL && error != EROFS) fail(path, "cannot sync", error);
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void publish(const fs::path& temporary, const fs::path& path)
{
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "cannot write", errno);
    sync_path(folder_of(path), O_RDONLY | O_DIRECTORY);
}

std::string random_suffix()
{
    static std::mutex mutex;
    static std::random_device device; // names of temporary files only; no result depends on it
    const std::lock_guard lock(mutex);
    std::ostringstream text;
    text << std::hex << device() << device();
    return text.str();
}

void sync_tree(const fs::path& folder)
{
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        sync_path(entry.path(), entry.is_directory() ? O_RDONLY | O_DIRECTORY : O_RDONLY);
}

// Errors name `path`, as which the file will be published.
void write_file(const fs::path& temporary, std::span<const std::byte> bytes, const fs::path& path)
{
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (descriptor < 0) fail(path, "cannot write", errno);
    try {
        write_all(descriptor, bytes, path);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    if (::close(descriptor) != 0) fail(path, "cannot write", errno);
}

} // namespace

void fail_writing(const fs::path& path, const char* doing, int error, const char* what_to_do)
{
    std::string message = path.string() + ": " + doing + ": " + std::strerror(error);
    if (what_to_do) message += std::string("; ") + what_to_do;
    if (error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO || error == ENOMEM)
        throw ResourceError(message + "; nothing was left half-written");
    throw InputError(message);
}

TemporaryPath::TemporaryPath(const fs::path& beside)
    : path_(folder_of(beside) / ("." + beside.filename().string() + "." + this_host() + "." +
                                 std::to_string(::getpid()) + "." + random_suffix() + ".tmp"))
{
    const std::lock_guard lock(unfinished_mutex);
    unfinished.push_back(path_);
}

TemporaryPath::~TemporaryPath()
{
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    const std::lock_guard lock(unfinished_mutex);
    std::erase(unfinished, path_);
}

void remove_unfinished_files() noexcept
{
    const std::lock_guard lock(unfinished_mutex);
    for (const auto& path : unfinished) {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
}

void write_all(int descriptor, std::span<const std::byte> bytes, const fs::path& path)
{
    while (!bytes.empty()) {
        const ssize_t written =
            ::write(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), std::size_t{1} << 30));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail(path, "cannot write", errno);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write)
{
    const TemporaryPath temporary(path);
    write(temporary.path());
    sync_path(temporary.path(), O_RDONLY);
    publish(temporary.path(), path);
}

void write_atomically(const fs::path& path, std::span<const std::byte> bytes)
{
    write_atomically(path, [&](const fs::path& temporary) { write_file(temporary, bytes, path); });
}

void write_synced(const fs::path& path, std::string_view text)
{
    write_file(path, std::as_bytes(std::span(text.data(), text.size())), path);
    sync_file(path);
}

void write_atomically(const fs::path& path, std::string_view text)
{
    write_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

namespace {

void write_folder(const fs::path& path, const std::function<void(const fs::path&)>& write, bool is_synced)
{
    const TemporaryPath temporary(path);
    if (::mkdir(temporary.path().c_str(), 0755) != 0) fail(path, "cannot make the folder", errno);
    write(temporary.path());
    if (is_synced) sync_tree(temporary.path());
    const TemporaryPath old(path);
    std::error_code missing;
    fs::rename(path, old.path(), missing); // a folder cannot be renamed over a full one
    if (::rename(temporary.path().c_str(), path.c_str()) != 0) fail(path, "cannot write", errno);
    if (is_synced) sync_folder(folder_of(path));
}

} // namespace

void write_folder_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write)
{
    write_folder(path, write, true);
}

void replace_folder(const fs::path& path, const std::function<void(const fs::path&)>& write)
{
    write_folder(path, write, false);
}

void sync_file(const fs::path& path) { sync_path(path, O_RDONLY); }
void sync_folder(const fs::path& path) { sync_path(path, O_RDONLY | O_DIRECTORY); }

void replace_file(const fs::path& path, std::string_view text)
{
    std::error_code missing;
    if (fs::file_size(path, missing) == text.size() && !missing && read_text(path) == text) {
        ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0); // make goes by the time of what a stage wrote last
        return;
    }
    remove_abandoned_files(folder_of(path), path.filename().string());
    const TemporaryPath temporary(path);
    std::ofstream file(temporary.path(), std::ios::binary);
    if (!file.write(text.data(), static_cast<std::streamsize>(text.size())).flush()) fail(path, "cannot write", errno);
    file.close();
    if (::rename(temporary.path().c_str(), path.c_str()) != 0) fail(path, "cannot write", errno);
}

std::vector<fs::path> abandoned_files(const fs::path& folder, std::int64_t foreign_before)
{
    std::vector<fs::path> abandoned;
    std::error_code error;
    for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator();
         it.increment(error)) {
        const auto temporary = parse_temporary(it->path().filename().string());
        if (temporary && is_abandoned(*temporary, it->path(), foreign_before)) abandoned.push_back(it->path());
    }
    return abandoned;
}

std::size_t remove_abandoned_files(const fs::path& folder, std::string_view name) noexcept
{
    std::size_t removed = 0;
    for (const auto& path : abandoned_files(folder, std::numeric_limits<std::int64_t>::min())) {
        std::error_code error;
        if (belongs_to(*parse_temporary(path.filename().string()), name) && fs::remove_all(path, error) > 0 && !error)
            ++removed;
    }
    return removed;
}

std::string read_text(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    if (!file || !(content << file.rdbuf()).good()) {
        std::error_code ignored;
        if (file && fs::file_size(path, ignored) == 0 && !fs::is_directory(path)) return {};
        throw InputError(path.string() + ": cannot read: " + std::strerror(errno));
    }
    return content.str();
}

} // namespace quoin
