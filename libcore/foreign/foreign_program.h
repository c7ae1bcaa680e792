// A program that is not Quoin's own: one that honours the stage contract (--describe, --in, --out, --set ...), or a
// command line that a YAML file describes (pipeline/command_file.h).
#pragma once

#include "base/param.h"
#include "stage/stage.h"

#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

struct ForeignProgram {
    Stage stage; // its implementation is a digest of its code
    std::vector<ParamSpec> params;
    std::vector<std::string> words; // the command line with placeholders; of a program of the contract, the program
    bool honours_contract = false;
};

// `use` is the path of a program, "x.yaml" or "x.yaml#stage"; the content of the files `code` enters the key too.
// Throws UsageError saying what is wrong with the program or its description.
ForeignProgram load_foreign_program(const std::string& use, const std::vector<std::filesystem::path>& code);

} // namespace quoin
