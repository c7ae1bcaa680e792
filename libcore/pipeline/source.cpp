#include "pipeline/source.h"

#include "base/error.h"
#include "base/param.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <sstream>
#include <tuple>

namespace quoin {
namespace {

// The line of the text with a caret under the column; tabs are shown as one blank so that the caret stays in place.
std::string excerpt(const Position& position)
{
    if (!position.source || position.line < 1 || position.line > static_cast<int>(position.source->lines.size()))
        return {};
    std::string line = position.source->lines[position.line - 1];
    std::ranges::replace(line, '\t', ' ');
    const std::string number = position.source->is_argument ? "" : std::to_string(position.line);
    return fmt::format("\n  {} | {}\n  {} | {}^", number, line, std::string(number.size(), ' '),
                       std::string(std::max(0, position.column - 1), ' '));
}

} // namespace

std::shared_ptr<const SourceText> make_source(std::string name, const std::string& text)
{
    auto source = std::make_shared<SourceText>();
    source->name = std::move(name);
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        if (line.ends_with('\r')) line.pop_back();
        source->lines.push_back(std::move(line));
    }
    return source;
}

Position argument_position(const std::string& flag, const std::string& argument, int column)
{
    return {std::make_shared<SourceText>(SourceText{flag, {argument}, true}), 1, column};
}

std::string to_string(const Position& position)
{
    if (!position.source) return "pipeline";
    if (position.source->is_argument || position.line < 1) return position.source->name;
    return fmt::format("{}:{}:{}", position.source->name, position.line, position.column);
}

// The same is said once: a variant repeats what is wrong with its pipeline.
void Problems::put(const Position& position, std::string message)
{
    const auto is_same = [&](const Entry& entry) {
        return entry.message == message && to_string(entry.position) == to_string(position);
    };
    if (std::ranges::none_of(entries_, is_same)) entries_.push_back({position, std::move(message)});
}

void Problems::add(const Position& position, const std::string& message)
{
    ++errors_;
    put(position, message);
}

void Problems::warn(const Position& position, const std::string& message) { put(position, "warning: " + message); }

void Problems::add_all(const Problems& others)
{
    entries_.insert(entries_.end(), others.entries_.begin(), others.entries_.end());
    errors_ += others.errors_;
}

std::string Problems::text() const
{
    std::map<const SourceText*, std::size_t> rank; // texts in the order in which they were first blamed
    for (const auto& entry : entries_)
        rank.emplace(entry.position.source.get(), rank.size());
    auto sorted = entries_;
    std::ranges::stable_sort(sorted, {}, [&](const Entry& entry) {
        return std::tuple(rank.at(entry.position.source.get()), entry.position.line, entry.position.column);
    });
    std::string text;
    for (const auto& [position, message] : sorted)
        text += fmt::format("{}{}: {}{}", text.empty() ? "" : "\n", to_string(position), message, excerpt(position));
    return text;
}

void Problems::throw_if_any() const
{
    if (has_errors()) throw UsageError(text());
}

std::string hint(const std::string& name, const std::vector<std::string>& candidates)
{
    if (const std::string near = nearest_name(name, candidates); !near.empty())
        return fmt::format("; did you mean '{}'?", near);
    return candidates.empty() ? "" : fmt::format("; there is: {}", fmt::join(candidates, ", "));
}

} // namespace quoin
