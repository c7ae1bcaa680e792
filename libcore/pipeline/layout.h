// Where the results of a run lie: OUT/<scan>/<stage>/<port>.safetensors, the export under OUT/<scan>/model/.
#pragma once

#include <filesystem>
#include <string>

namespace quoin {

struct Layout {
    std::filesystem::path out;   // absolute
    std::filesystem::path store; // absolute

    std::filesystem::path scan_folder(const std::string& scan) const { return out / scan; }
    std::filesystem::path stage_folder(const std::string& scan, const std::string& stage) const
    {
        return out / scan / stage;
    }

    // The stage's last run record.
    std::filesystem::path record(const std::string& scan, const std::string& stage) const;

    // The output `port`; `schema` tells files from folders. The model of the stage named `export` is OUT/<scan>/model.
    std::filesystem::path output(const std::string& scan, const std::string& stage, const std::string& port,
                                 const std::string& schema) const;
};

} // namespace quoin
