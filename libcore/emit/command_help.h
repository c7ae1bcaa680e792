// What the verbs and stages say of themselves: the source of reference pages and shell completion.
#pragma once

#include "pipeline/description.h"

#include <string>
#include <vector>

namespace quoin {

struct OptionHelp {
    std::string flags; // "-S,--set", or the name of a positional argument
    std::string doc;
};

struct VerbHelp {
    std::string name;
    std::string summary;
    std::vector<OptionHelp> options;
};

struct CommandHelp {
    std::vector<VerbHelp> verbs;
    std::vector<StageDescription> stages;
};

// From what `quoin VERB --list-options` prints: the summary, then a line an option, flags and sentence separated by a
// tab.
VerbHelp parse_verb_help(const std::string& name, const std::string& text);

// "float 0..180 deg", or the choices.
std::string range_text(const ParamSpec& spec);

} // namespace quoin
