// A command line described in YAML, so that a program that knows nothing of Quoin can stand in a pipeline. It is a file
// of its own (`use: ./smooth.yaml`), or the same keys in a stage of a pipeline ("pipeline.yaml#smooth"):
//
//     exec: [python3, smooth.py, "{in.plane_mesh}", "{out.plane_mesh}", "--rounds={param.rounds}"]
//     code: [helpers.py]                 # files that enter the key; those that `exec` names do so anyhow
//     describe:
//       summary: moves vertices to the mean of their neighbours
//       impl_version: 1
//       inputs: {plane_mesh: {}}         # PORT: {schema: the port's name, version: 1, optional: false, doc: ""}
//       outputs: {plane_mesh: {}}
//       params:
//         rounds: {type: int, default: 3, min: 0, max: 10, unit: "", doc: how often}
//
// Placeholders: {in.PORT} {out.PORT} {param.NAME} {scan_root} {threads}. A word whose placeholder stands for nothing
// (an input that is not wired) is left out. There is no shell; relative files are looked for beside the YAML file.
#pragma once

#include "pipeline/description.h"
#include "pipeline/source.h"

#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

struct CommandFile {
    StageDescription description;
    std::vector<std::string> exec;           // words; files beside the YAML file by their absolute paths
    std::vector<std::string> words;          // the same as written: what enters the key
    std::vector<std::filesystem::path> code; // files whose content enters the key
};

// True for what names such a description: "x.yaml", or "x.yaml#stage".
bool is_command_file(const std::string& use);

// The path of the YAML file without "#stage".
std::filesystem::path command_file_path(const std::string& use);

// What is wrong is added to `problems`; throws UsageError when the file cannot be read.
CommandFile read_command_file(const std::string& use, Problems& problems);

} // namespace quoin
