// A folder with small real stages (tests/toys), scans for them and a pipeline; and the driver run in it.
#pragma once

#include "build_paths.h"
#include "pipeline/run_record.h"
#include "support/command.h"
#include "support/temporary_folder.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace quoin::test {

using Digests = std::map<std::string, std::string>; // payloads by "scan/stage.port"

// read -> small, large (both scale) -> join -> weigh
constexpr const char* kWorkshopPipeline = R"(version: 1
stages:
  read: {use: read, in: {folder: $scan}}
  small: {use: scale, in: {mesh: read.mesh}, params: {factor: 0.5}}
  large: {use: scale, in: {mesh: read.mesh}, params: {note: "it's $5 & more"}}
  join: {use: join, in: {mesh: small.mesh, other: large.mesh}}
  weigh: {use: weigh, in: {mesh: join.mesh}}
)";

class Workshop {
public:
    explicit Workshop(const std::vector<std::string>& scans)
    {
        for (const char* stage : {"read", "scale", "join", "weigh"}) {
            std::filesystem::create_directories(folder_ / "stages");
            std::filesystem::create_symlink(QUOIN_BINARY_DIR "/bin/toy_stages", folder_ / "stages" / stage);
        }
        write("p.yaml", kWorkshopPipeline);
        for (std::size_t i = 0; i < scans.size(); ++i) {
            write("scans/" + scans[i] + "/points.txt", "0 0 " + std::to_string(i) + "\n1 2 3\n");
            scan_options_ += " --scan scans/" + scans[i];
        }
    }

    const std::filesystem::path& path() const { return folder_.path(); }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

    void write(const std::string& name, const std::string& text) const
    {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
    }

    // A shell command line in the folder, with the toy stages in place of Quoin's.
    CommandResult shell(const std::string& command) const
    {
        return run_command("cd '" + path().string() + "' && unset QUOIN_STORE && export QUOIN_STAGES='" +
                           (path() / "stages").string() + "' && { " + command + "; }");
    }
    CommandResult quoin(const std::string& arguments) const
    {
        return shell(QUOIN_BINARY_DIR "/bin/quoin " + arguments);
    }
    const std::string& scan_options() const { return scan_options_; } // " --scan scans/a --scan scans/b"

    Digests digests(const std::string& out) const
    {
        Digests digests;
        for (const auto& scan : std::filesystem::directory_iterator(folder_ / out)) {
            if (!scan.is_directory() || scan.path().filename().string().starts_with('.')) continue;
            for (const auto& stage : std::filesystem::directory_iterator(scan))
                if (const auto record = read_run_record(stage.path() / "record.json"))
                    for (const auto& [port, payload] : record->outputs)
                        digests[(scan.path().filename() / stage.path().filename()).string() + "." + port] = payload;
        }
        return digests;
    }

private:
    TemporaryFolder folder_;
    std::string scan_options_;
};

} // namespace quoin::test
