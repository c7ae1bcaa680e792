// YAML as Quoin reads it: strict, and every node knows where it stands. Duplicate keys, keys that are not text, several
// documents in a file and tabs are refused, unlike in the library beneath.
#pragma once

#include "pipeline/source.h"

#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

struct YamlEntry;

struct YamlNode {
    enum class Kind { Null, Scalar, List, Map };
    Kind kind = Kind::Null;
    Position position;
    std::string text;               // of a scalar, as written (without quotes)
    std::vector<YamlNode> items;    // of a list
    std::vector<YamlEntry> entries; // of a map, in the order of the file; keys are unique

    bool is_null() const { return kind == Kind::Null; }
    bool is_scalar() const { return kind == Kind::Scalar; }
    bool is_map() const { return kind == Kind::Map; }
};

struct YamlEntry {
    std::string key;
    Position position; // of the key
    YamlNode value;
};

// The document of a text; what is wrong with it is added to `problems` (and the node is then incomplete).
YamlNode parse_yaml(const std::string& name, const std::string& text, Problems& problems);

// Throws UsageError naming the file when it cannot be read.
YamlNode load_yaml(const std::filesystem::path& path, Problems& problems);

// The value of `key`, or nullptr.
const YamlNode* find(const YamlNode& map, const std::string& key);

// Adds a problem for every key that is not in `known`; `what` names the map in the message ("a stage").
void refuse_unknown_keys(const YamlNode& map, const std::vector<std::string>& known, const std::string& what,
                         Problems& problems);

// True when the node is a map; otherwise a problem that says that `what` is expected to be one.
bool expect_map(const YamlNode& node, const std::string& what, Problems& problems);

} // namespace quoin
