// Descriptions of programs remembered between runs of the driver: one is valid while the file system says that the
// program is the same file, unchanged. Only compiled programs are remembered, as a script's answer may depend on other
// files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace quoin {

class DescriptionCache {
public:
    // `folder` empty = remember nothing; it need not exist.
    explicit DescriptionCache(std::filesystem::path folder);

    // What the program said when it was asked last; none when it was not, or has changed since.
    std::optional<std::string> find(const std::filesystem::path& program) const;
    void remember(const std::filesystem::path& program, const std::string& description) const;

private:
    std::filesystem::path place(const std::filesystem::path& program) const;
    std::filesystem::path folder_;
};

// $XDG_CACHE_HOME/quoin or ~/.cache/quoin; empty when there is neither.
std::filesystem::path user_cache_folder();

} // namespace quoin
