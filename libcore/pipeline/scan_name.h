#pragma once

#include <filesystem>
#include <string>

namespace quoin {

// The name of a scan that is given none: its folder's, with or without a slash behind it.
std::string scan_name(const std::filesystem::path& folder);

} // namespace quoin
