#include "store/identity.h"

#include "artifact/artifact.h"
#include "base/error.h"
#include "store/manifest.h"

#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;

std::string versioned_schema(const std::string& schema, int version) { return fmt::format("{}/{}", schema, version); }

InputIdentity identify_input(const InputPort& port, const fs::path& path, const fs::path& stat_cache)
{
    if (fs::is_directory(path)) return {versioned_schema(port.schema), folder_digest(path, stat_cache)};
    if (port.schema == "folder")
        throw InputError(fmt::format("{}: no such folder (input '{}')", path.string(), port.name));
    const ArtifactHeader header = read_artifact_header(path);
    if (header.schema != port.schema)
        throw InputError(fmt::format("{}: holds a '{}'; input '{}' takes a '{}'", path.string(), header.schema,
                                     port.name, port.schema));
    return {versioned_schema(header.schema, header.schema_version),
            header.payload.empty() ? read_artifact(path).payload() : header.payload};
}

ParamValues key_params(const std::vector<ParamSpec>& params, const ParamValues& values)
{
    ParamValues entering;
    for (const auto& spec : params) {
        const ParamValue& value = values.at(spec.name);
        const bool is_neutral = spec.flags.has_neutral && value == spec.default_value;
        if (spec.flags.affects_result && !is_neutral) entering[spec.name] = value;
    }
    return entering;
}

} // namespace quoin
