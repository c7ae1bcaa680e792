// The identity of a folder: SHA-256 over its sorted relative paths, sizes and contents. A stat cache remembers the
// digest of files that did not change since they were hashed, so that a thousand unchanged frames are recognised by
// stat alone.
#pragma once

#include <filesystem>
#include <string>

namespace quoin {

// `cache_folder` keeps the stat cache; empty = hash everything. Hidden files are left out. Throws InputError when
// `folder` is no readable folder.
std::string folder_digest(const std::filesystem::path& folder, const std::filesystem::path& cache_folder);

} // namespace quoin
