// "{in.mesh}" in the words of a described command line: a name in braces that stands for something else. Braces around
// anything that is no name (letters, digits, '.', '_', '-') are left as they are.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

// The names in the placeholders of a word, from left to right.
std::vector<std::string> placeholders_in(const std::string& word);

// The word with every placeholder replaced by its value; none when one of them stands for nothing.
std::optional<std::string>
fill_placeholders(const std::string& word,
                  const std::function<std::optional<std::string>(const std::string& name)>& value_of);

} // namespace quoin
