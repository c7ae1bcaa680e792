#include "base/atomic_file.h"

#include "base/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <mutex>
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

[[noreturn]] void fail(const fs::path& path, const char* doing, int error)
{
    const std::string message = path.string() + ": " + doing + ": " + std::strerror(error);
    if (error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO || error == ENOMEM) throw ResourceError(message + "; nothing was left half-written");
    throw InputError(message);
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

} // namespace

TemporaryPath::TemporaryPath(const fs::path& beside)
    : path_(folder_of(beside) / ("." + beside.filename().string() + "." + std::to_string(::getpid()) + "." + random_suffix() + ".tmp"))
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
        const ssize_t written = ::write(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), std::size_t{1} << 30));
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
    write_atomically(path, [&](const fs::path& temporary) {
        const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
        if (descriptor < 0) fail(path, "cannot write", errno);
        try {
            write_all(descriptor, bytes, path);
        } catch (...) {
            ::close(descriptor);
            throw;
        }
        if (::close(descriptor) != 0) fail(path, "cannot write", errno);
    });
}

void write_atomically(const fs::path& path, std::string_view text)
{
    write_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

void write_folder_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write)
{
    const TemporaryPath temporary(path);
    if (::mkdir(temporary.path().c_str(), 0755) != 0) fail(path, "cannot make the folder", errno);
    write(temporary.path());
    for (const auto& entry : fs::recursive_directory_iterator(temporary.path()))
        sync_path(entry.path(), entry.is_directory() ? O_RDONLY | O_DIRECTORY : O_RDONLY);
    const TemporaryPath old(path);
    std::error_code missing;
    fs::rename(path, old.path(), missing); // a folder cannot be renamed over a full one
    publish(temporary.path(), path);
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
