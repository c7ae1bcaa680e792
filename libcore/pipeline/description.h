// What a stage executable says about itself (`STAGE --describe`): the one source for wiring checks, parameter checks
// and help.
#pragma once

#include "base/param.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace quoin {

struct PortDescription {
    std::string name;
    std::string schema;
    int version = 1; // newest version that is read, or the one that is written
    bool optional = false;
    std::string doc;
};

struct StageDescription {
    std::string name;
    std::string summary;
    std::string implementation; // as it enters the cache key; "" = a program that does not look into the store itself
    int impl_version = 1;
    std::vector<PortDescription> inputs;
    std::vector<PortDescription> outputs;
    std::vector<ParamSpec> params;
    bool reads_images = false;     // takes --scan-root
    std::vector<std::string> code; // of a foreign program: further files that it is made of, beside it
    int cores = 0;                 // that it can use; 0 = any number
    std::string memory_formula;    // of input size (base/formula.h); "" = not declared
};

// A stage executable and its description. A foreign program is run by another one (run-command), which is told by its
// first arguments what to run.
struct Program {
    std::filesystem::path path;
    StageDescription description;
    std::vector<std::string> leading = {};        // arguments before the stage's own
    std::vector<std::filesystem::path> code = {}; // of a foreign program: the files whose content enters the key
};

// Folders are wired like artifacts, but lie on disk as directories.
bool is_directory_schema(std::string_view schema);

// The port of that name, or nullptr.
const PortDescription* find_port(const std::vector<PortDescription>& ports, std::string_view name);
std::vector<std::string> port_names(const std::vector<PortDescription>& ports);

// From the JSON of --describe. Throws UsageError naming `who` and the key that is missing or of the wrong type.
StageDescription parse_description(const std::string& json, const std::string& who);

} // namespace quoin
