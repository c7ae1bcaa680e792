#include "pipeline/placeholders.h"

#include <algorithm>

namespace quoin {
namespace {

bool is_placeholder(const std::string& text)
{
    return !text.empty() && std::ranges::all_of(text, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-';
    });
}

struct Span {
    std::size_t begin = 0, end = 0; // of the braces; end is one past
    std::string name;
};

std::vector<Span> find_spans(const std::string& word)
{
    std::vector<Span> spans;
    for (std::size_t open = word.find('{'); open != std::string::npos; open = word.find('{', open + 1)) {
        const std::size_t close = word.find('}', open);
        if (close == std::string::npos) break;
        const std::string name = word.substr(open + 1, close - open - 1);
        if (is_placeholder(name)) spans.push_back({open, close + 1, name});
    }
    return spans;
}

} // namespace

std::vector<std::string> placeholders_in(const std::string& word)
{
    std::vector<std::string> names;
    for (const auto& span : find_spans(word))
        names.push_back(span.name);
    return names;
}

std::optional<std::string>
fill_placeholders(const std::string& word,
                  const std::function<std::optional<std::string>(const std::string& name)>& value_of)
{
    std::string filled;
    std::size_t at = 0;
    for (const auto& span : find_spans(word)) {
        const auto value = value_of(span.name);
        if (!value) return std::nullopt;
        filled += word.substr(at, span.begin - at) + *value;
        at = span.end;
    }
    return filled + word.substr(at);
}

} // namespace quoin
