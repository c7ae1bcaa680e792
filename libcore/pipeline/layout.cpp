#include "pipeline/layout.h"

#include "pipeline/description.h"

namespace quoin {

std::filesystem::path Layout::record(const std::string& scan, const std::string& stage) const
{
    return stage_folder(scan, stage) / "record.json";
}

std::filesystem::path Layout::output(const std::string& scan, const std::string& stage, const std::string& port,
                                     const std::string& schema) const
{
    if (!is_directory_schema(schema)) return stage_folder(scan, stage) / (port + ".safetensors");
    if (schema == "model" && stage == "export") return scan_folder(scan) / "model";
    return stage_folder(scan, stage) / port;
}

} // namespace quoin
