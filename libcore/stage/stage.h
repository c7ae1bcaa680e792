// How a stage is declared and run. A stage's main declares its ports and parameters, loads, makes one call, saves:
//
//     int main(int argc, char** argv)
//     {
//         const quoin::Stage stage{
//             .name = "merge",
//             .summary = "joins neighbouring clusters that lie in one plane",
//             .impl_version = 1,
//             .inputs = {{"plane_mesh", "clusters of the dense mesh"}},
//             .outputs = {{"plane_mesh", "the same faces in fewer planes"}},
//         };
//         return run_stage<MergeParams>(stage, argc, argv, [](const StageRun& run, const MergeParams& params) {
//             run.write("plane_mesh", merge_planes(read_plane_mesh(run.in("plane_mesh")), params));
//         });
//     }
//
// The runner is the only try/catch: it parses the command line, answers --help, --describe and --key, looks into the
// store, runs the body with threads, memory limit, progress and signals set up, publishes, and turns errors into exit
// codes.
#pragma once

#include "artifact/artifact.h"
#include "base/param.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace quoin {

// A port is named after its schema; "folder" and "model" are directories.
struct Port {
    std::string name;
    std::string doc;
    bool optional = false;
    std::string schema = {}; // "" = the port's name
    const std::string& schema_name() const { return schema.empty() ? name : schema; }
};

struct Resources { // formulas, as text, of the input's size: "bytes(mesh) * 12 + 200M"
    std::string memory = {};
    int cores = 0; // 0 = any number
};

struct Stage {
    std::string name;
    std::string summary;
    int impl_version = 1; // raise it when results change
    std::vector<Port> inputs;
    std::vector<Port> outputs;
    bool reads_images = false; // takes --scan-root
    Resources resources = {};
    std::string implementation =
        {}; // "" = "builtin/<name>"; of a foreign program, what its code is: "foreign/<digest>"
};

// What the body of a stage sees of its run.
class StageRun {
public:
    // Path of an input; has() tells whether an optional one was given.
    const std::filesystem::path& in(const std::string& port) const;
    bool has(const std::string& port) const;
    bool wants(const std::string& port) const; // was this output asked for?
    const std::filesystem::path& scan_root() const;

    // Publishes one output: schema types through their to_artifact (schema/schema.h) ...
    template <class T>
    void write(const std::string& port, T&& value) const
    {
        write_artifact_to(port, to_artifact(std::forward<T>(value)));
    }
    // ... folders by a function that fills an empty temporary folder.
    void write_folder(const std::string& port, const std::function<void(const std::filesystem::path&)>& fill) const;

    struct State;
    explicit StageRun(State& state) : state_(&state) {}

private:
    void write_artifact_to(const std::string& port, Artifact artifact) const;
    State* state_;
};

using StageBody = std::function<void(const StageRun&, const ParamValues&)>;
int run_stage(const Stage& stage, const std::vector<ParamSpec>& params, int argc, char** argv, const StageBody& body);

template <class Params, class Body>
int run_stage(const Stage& stage, int argc, char** argv, const Body& body)
{
    return run_stage(stage, specs_of<Params>(), argc, argv,
                     [&](const StageRun& run, const ParamValues& values) { body(run, params_from<Params>(values)); });
}

} // namespace quoin
