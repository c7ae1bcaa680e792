#include "pipeline/line_reader.h"

#include <nlohmann/json.hpp>

namespace quoin {
namespace {

constexpr std::size_t kLongestLine = 1 << 16;  // bytes; what is longer is cut into such pieces
constexpr std::size_t kLongestShown = 1 << 10; // bytes of a piece

void take_line(std::string line, const std::function<void(const std::string&)>& take)
{
    while (line.ends_with('\r'))
        line.pop_back();
    if (const std::size_t last = line.rfind('\r'); last != std::string::npos) line.erase(0, last + 1);
    if (line.size() > kLongestShown) line = line.substr(0, kLongestShown) + " ...";
    if (!line.empty()) take(line);
}

} // namespace

std::optional<TaskProgress> parse_progress(std::string_view line)
{
    if (!line.starts_with('{')) return std::nullopt;
    const auto json = nlohmann::json::parse(line, nullptr, false);
    const auto has = [&](const char* key, bool is_right) { return json.contains(key) && is_right; };
    if (!json.is_object() || !has("part", json.value("part", nlohmann::json()).is_string())) return std::nullopt;
    if (!json.value("done", nlohmann::json()).is_number_unsigned() ||
        !json.value("total", nlohmann::json()).is_number_unsigned())
        return std::nullopt;
    return TaskProgress{json["part"], json["done"], json["total"]};
}

void LineReader::take_lines(const std::function<void(const std::string&)>& take)
{
    std::size_t start = 0;
    for (std::size_t end = pending.find('\n'); end != std::string::npos; end = pending.find('\n', start)) {
        take_line(pending.substr(start, end - start), take);
        start = end + 1;
    }
    pending.erase(0, start);
    if (pending.size() > kLongestLine) take_line(std::exchange(pending, {}), take); // no line at all
}

void LineReader::take_rest(const std::function<void(const std::string&)>& take)
{
    take_lines(take);
    take_line(std::exchange(pending, {}), take);
}

} // namespace quoin
