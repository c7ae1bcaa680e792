// Names by pattern: * stands for any letters, ? for one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace quoin {

bool matches(std::string_view text, std::string_view pattern);

// The files and folders of an absolute pattern like /data/*/scan, sorted. Hidden ones only where the pattern has the
// dot.
std::vector<std::filesystem::path> glob(const std::filesystem::path& pattern);

} // namespace quoin
