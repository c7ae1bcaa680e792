#include "pipeline/yaml.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <yaml-cpp/yaml.h>

namespace quoin {
namespace {

// Bounds against documents that aliases blow up; a pipeline of a thousand stages is far below them.
constexpr std::size_t kMaxNodes = 200'000;
constexpr int kMaxDepth = 32;

class Converter {
public:
    Converter(std::shared_ptr<const SourceText> source, Problems& problems)
        : source_(std::move(source)), problems_(problems)
    {
    }

    YamlNode convert(const YAML::Node& from, const Position& fallback, int depth = 0)
    {
        YamlNode node;
        node.position = position_of(from, fallback);
        if (++nodes_ > kMaxNodes || depth > kMaxDepth) {
            if (!overflowed_) problems_.add(node.position, "nested too deeply, or blown up by aliases");
            overflowed_ = true;
            return node;
        }
        if (from.IsScalar()) {
            node.kind = YamlNode::Kind::Scalar;
            node.text = from.Scalar();
        } else if (from.IsSequence()) {
            node.kind = YamlNode::Kind::List;
            for (const auto& item : from)
                node.items.push_back(convert(item, node.position, depth + 1));
        } else if (from.IsMap()) {
            node.kind = YamlNode::Kind::Map;
            convert_entries(from, node, depth);
        }
        return node;
    }

private:
    Position position_of(const YAML::Node& node, const Position& fallback) const
    {
        const YAML::Mark mark = node.Mark();
        if (mark.is_null() || node.IsNull()) return fallback;
        return {source_, mark.line + 1, mark.column + 1};
    }

    void convert_entries(const YAML::Node& from, YamlNode& node, int depth)
    {
        std::map<std::string, Position> seen;
        for (const auto& pair : from) {
            const Position position = position_of(pair.first, node.position);
            if (!pair.first.IsScalar()) {
                problems_.add(position, "a key must be a plain word");
                continue;
            }
            const std::string& key = pair.first.Scalar();
            const auto [first, is_new] = seen.emplace(key, position);
            if (!is_new) {
                problems_.add(position, fmt::format("key '{}' stands here a second time; the first is in line {}", key,
                                                    first->second.line));
                continue;
            }
            node.entries.push_back({key, position, convert(pair.second, position, depth + 1)});
        }
    }

    std::shared_ptr<const SourceText> source_;
    Problems& problems_;
    std::size_t nodes_ = 0;
    bool overflowed_ = false;
};

// The library's own message for a tab is "illegal map value".
bool refuse_tabs(const std::shared_ptr<const SourceText>& source, Problems& problems)
{
    bool found = false;
    for (std::size_t i = 0; i < source->lines.size(); ++i) {
        const std::size_t end = source->lines[i].find_first_not_of(" \t");
        const std::size_t tab = source->lines[i].substr(0, end).find('\t');
        if (end == std::string::npos || tab == std::string::npos) continue;
        problems.add({source, static_cast<int>(i) + 1, static_cast<int>(tab) + 1},
                     "a tab in the indentation; YAML takes blanks only");
        found = true;
    }
    return found;
}

} // namespace

YamlNode parse_yaml(const std::string& name, const std::string& text, Problems& problems)
{
    const auto source = make_source(name, text);
    const Position start{source, 1, 1};
    YamlNode empty;
    empty.position = start;
    if (refuse_tabs(source, problems)) return empty;
    try {
        const std::vector<YAML::Node> documents = YAML::LoadAll(text);
        if (documents.size() > 1)
            problems.add({source, documents[1].Mark().line + 1, documents[1].Mark().column + 1},
                         "a second document; a file holds one");
        return documents.empty() ? empty : Converter(source, problems).convert(documents[0], start);
    } catch (const YAML::Exception& error) {
        problems.add({source, error.mark.line + 1, error.mark.column + 1},
                     fmt::format("this is not YAML: {} (check indentation, colons, quotes and brackets here and above)",
                                 error.msg));
        return empty;
    }
}

YamlNode load_yaml(const std::filesystem::path& path, Problems& problems)
{
    if (!std::filesystem::is_regular_file(path)) throw UsageError(fmt::format("{}: no such file", path.string()));
    return parse_yaml(path.string(), read_text(path), problems);
}

const YamlNode* find(const YamlNode& map, const std::string& key)
{
    const auto entry = std::ranges::find(map.entries, key, &YamlEntry::key);
    return entry == map.entries.end() ? nullptr : &entry->value;
}

void refuse_unknown_keys(const YamlNode& map, const std::vector<std::string>& known, const std::string& what,
                         Problems& problems)
{
    for (const auto& entry : map.entries)
        if (std::ranges::find(known, entry.key) == known.end())
            problems.add(entry.position, fmt::format("{} has no key '{}'{}", what, entry.key, hint(entry.key, known)));
}

bool expect_map(const YamlNode& node, const std::string& what, Problems& problems)
{
    if (node.is_map()) return true;
    problems.add(node.position, fmt::format("{} is expected to be a map (key: value)", what));
    return false;
}

} // namespace quoin
