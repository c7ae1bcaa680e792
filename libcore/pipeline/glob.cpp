#include "pipeline/glob.h"

#include <algorithm>

namespace quoin {
namespace fs = std::filesystem;

bool matches(std::string_view text, std::string_view pattern)
{
    if (pattern.empty()) return text.empty();
    if (pattern.front() == '*')
        return matches(text, pattern.substr(1)) || (!text.empty() && matches(text.substr(1), pattern));
    return !text.empty() && (pattern.front() == '?' || pattern.front() == text.front()) &&
           matches(text.substr(1), pattern.substr(1));
}

std::vector<fs::path> glob(const fs::path& pattern)
{
    std::vector<fs::path> found{pattern.root_path()};
    for (const auto& part : pattern.relative_path()) {
        std::vector<fs::path> deeper;
        const bool is_plain = part.string().find_first_of("*?") == std::string::npos;
        for (const auto& folder : found) {
            if (is_plain && fs::exists(folder / part)) deeper.push_back(folder / part);
            if (is_plain || !fs::is_directory(folder)) continue;
            for (const auto& entry : fs::directory_iterator(folder)) {
                const std::string name = entry.path().filename().string();
                const bool is_hidden = name.starts_with('.') && !part.string().starts_with('.');
                if (!is_hidden && matches(name, part.string())) deeper.push_back(entry.path());
            }
        }
        found = std::move(deeper);
    }
    std::ranges::sort(found);
    return found;
}

} // namespace quoin
