// Runs of the driver over the toy path: source -> two scales -> join -> folder.
#pragma once

#include "build_paths.h"
#include "pipeline/run_record.h"
#include "support/command.h"
#include "support/temporary_folder.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

namespace quoin::test {

using Digests = std::map<std::string, std::string>; // "stage.port" -> payload

class ToyRuns {
public:
    ToyRuns()
    {
        namespace fs = std::filesystem;
        fs::create_directories(path("stages"));
        fs::create_directories(path("room"));
        std::ofstream(path("room/frame")) << "a frame";
        for (const char* name : {"toy-source", "toy-scale", "toy-join", "toy-folder"})
            fs::create_symlink(QUOIN_BINARY_DIR "/bin/toy_path", path("stages") / name);
        std::ofstream(path("p.yaml")) << "version: 1\nstages:\n  source: {use: toy-source, in: {folder: $scan}}\n"
                                         "  left: {use: toy-scale, in: {mesh: source.mesh}}\n"
                                         "  right: {use: toy-scale, in: {mesh: source.mesh}, params: {factor: 3}}\n"
                                         "  join: {use: toy-join, in: {mesh: left.mesh, other: right.mesh}}\n"
                                         "  folder: {use: toy-folder, in: {mesh: join.mesh}}\n";
    }

    std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

    // The command line of a run in OUT with a store, to be run by a shell.
    std::string command(const std::string& out, const std::string& store, const std::string& options = {}) const
    {
        return shell("run p.yaml --scan room --out " + out + " --store " + store + " " + options);
    }
    std::string shell(const std::string& arguments) const
    {
        return "cd '" + folder_.path().string() + "' && QUOIN_STAGES='" + path("stages").string() +
               "' XDG_CACHE_HOME='" + path("cache").string() + "' exec '" + QUOIN_BINARY_DIR "/bin/quoin' " + arguments;
    }
    CommandResult quoin(const std::string& arguments) const { return run_command(shell(arguments)); }

    Digests digests(const std::string& out) const
    {
        Digests digests;
        for (const auto& entry : std::filesystem::directory_iterator(path(out) / "room"))
            if (const auto record = read_run_record(entry.path() / "record.json"))
                for (const auto& [port, payload] : record->outputs)
                    digests[entry.path().filename().string() + "." + port] = payload;
        return digests;
    }

    // Files below a folder of the store, by name.
    std::set<std::string> files(const std::string& folder) const
    {
        std::set<std::string> names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path(folder)))
            if (entry.is_regular_file()) names.insert(entry.path().filename().string());
        return names;
    }

private:
    TemporaryFolder folder_;
};

} // namespace quoin::test
