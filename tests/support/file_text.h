#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace quoin::test {

inline std::string file_text(const std::filesystem::path& path)
{
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

} // namespace quoin::test
