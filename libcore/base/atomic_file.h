// Files and folders that appear whole or not at all: written under a temporary name beside their place, synced,
// renamed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

namespace quoin {

// Writes by `write(temporary path)`, then publishes under `path`. Throws ResourceError (disk full) or InputError
// (folder missing or read-only), naming the path; the temporary file is gone in every case, a signal included.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);
void write_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_atomically(const std::filesystem::path& path, std::string_view text);

// The same for a folder: `write` fills an empty temporary folder, which then replaces `path`.
void write_folder_atomically(const std::filesystem::path& path,
                             const std::function<void(const std::filesystem::path&)>& write);

// Appends to an already opened file descriptor until all is written; throws ResourceError or InputError naming `path`.
void write_all(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path);

// A file's whole content. Throws InputError naming the path when it cannot be read.
std::string read_text(const std::filesystem::path& path);

// Removes every temporary file or folder being written; async-signal-safe enough for a dedicated signal thread.
void remove_unfinished_files() noexcept;

// A name beside `path` that no other process uses; it is removed by remove_unfinished_files() until released.
class TemporaryPath {
public:
    explicit TemporaryPath(const std::filesystem::path& beside);
    ~TemporaryPath();
    TemporaryPath(const TemporaryPath&) = delete;
    TemporaryPath& operator=(const TemporaryPath&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

} // namespace quoin
