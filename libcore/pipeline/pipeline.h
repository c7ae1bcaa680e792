// A pipeline as its author wrote it: stages, wires and parameters by name, each with its place in the text. Nothing is
// checked against the stages themselves yet; that is graph.h.
#pragma once

#include "pipeline/source.h"
#include "pipeline/yaml.h"

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
    Position name_position; // of the input's name
};

struct Setting {
    std::string text; // as written; its type is the stage's business
    Position position;
    Position name_position;
};

struct PipelineStage {
    std::string name; // in this pipeline
    Position position;
    std::string use; // the program: a short name, or a path against `use_folder`
    Position use_position;
    std::filesystem::path use_folder;
    std::vector<std::filesystem::path> code; // files that enter the key of a foreign program
    std::map<std::string, Wire> inputs;      // by port
    std::map<std::string, Setting> params;   // by name
};

// What a file says of variants and their comparison; study.h reads it.
struct StudySection {
    std::string key; // variants, matrix, ablate or report
    YamlNode value;
    std::filesystem::path folder; // of the file
};

struct Pipeline {
    std::string name;
    std::vector<PipelineStage> stages; // in the order of the file; names are unique
    std::vector<std::string> scans;    // "NAME=DIR" or "DIR", absolute
    std::vector<StudySection> study;   // those of the extended pipeline first

    PipelineStage* find(const std::string& stage);
    std::vector<std::string> stage_names() const;

    // Takes a stage out. Who read an output of it reads what it read itself on a port of the same name, or goes
    // without.
    void remove(const std::string& stage_name);
};

} // namespace quoin
