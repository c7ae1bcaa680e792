// Shell completion of `quoin VERB ...` and `quoin STAGE ...`: options, stages, parameters with their choices, ports.
#pragma once

#include "emit/command_help.h"

#include <string>

namespace quoin {

// For `source <(quoin emit completion bash)`.
std::string bash_completion(const CommandHelp& help);

// For a file _quoin in a folder of $fpath.
std::string zsh_completion(const CommandHelp& help);

} // namespace quoin
