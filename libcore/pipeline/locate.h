// Where the driver finds what belongs to it: beside its executable, wherever that lies.
#pragma once

#include <filesystem>
#include <string>

namespace quoin {

// The folder of the stage executables: $QUOIN_STAGES, <prefix>/libexec/quoin of an installation, or the driver's own
// folder.
std::filesystem::path stage_folder();

// The program that runs foreign ones as stages (foreign/foreign.h): beside the stages, or beside the running
// executable.
std::filesystem::path command_runner();

// The program that a shell would run for `name`; "" when $PATH has none.
std::filesystem::path find_in_path(const std::string& name);

// The file that a person means by `name`: a path; or "indoor" in the folder `kind` ("pipelines", "configs"), which is
// $QUOIN_PIPELINES or $QUOIN_CONFIGS, <prefix>/share/quoin/<kind>, or the source tree's. Throws UsageError with the
// names that there are.
std::filesystem::path find_yaml(const std::string& kind, const std::string& name);

} // namespace quoin
