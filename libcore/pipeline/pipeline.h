// A pipeline as its author wrote it: stages, wires and parameters by name, each with its place in the text. Nothing is
// checked against the stages themselves yet; that is graph.h.
#pragma once

#include "pipeline/source.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quoin {

// Where an input comes from: the output `port` of `stage`, or the scan folder of the run ("$scan").
struct Wire {
    std::string stage; // "" = the scan folder
    std::string port;
    Position position;
};

struct Setting {
    std::string text; // as written; its type is the stage's business
    Position position;
};

struct PipelineStage {
    std::string name; // in this pipeline
    Position position;
    std::string use; // the program: a short name, or a path against `use_folder`
    Position use_position;
    std::filesystem::path use_folder;
    std::map<std::string, Wire> inputs;    // by port
    std::map<std::string, Setting> params; // by name
};

struct Pipeline {
    std::string name;
    std::vector<PipelineStage> stages; // in the order of the file; names are unique

    PipelineStage* find(const std::string& stage);
    std::vector<std::string> stage_names() const;
};

} // namespace quoin
