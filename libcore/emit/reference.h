#pragma once

#include "emit/command_help.h"

#include <map>
#include <string>

namespace quoin {

// Markdown pages by file name: README.md with the verbs, and one a stage.
std::map<std::string, std::string> reference_pages(const CommandHelp& help);

} // namespace quoin
