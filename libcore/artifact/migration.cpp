#include "artifact/migration.h"

#include "base/error.h"

#include <fmt/format.h>
#include <functional>

namespace quoin {
namespace {

using Step = std::function<Artifact(Artifact)>;

// {schema, version it starts from} -> the same content at the next version.
const std::map<std::pair<std::string, int>, Step>& steps()
{
    static const std::map<std::pair<std::string, int>, Step> table;
    return table;
}

} // namespace

Artifact migrate(Artifact artifact, int newest, const std::filesystem::path& path)
{
    while (artifact.schema_version < newest) {
        const auto step = steps().find({artifact.schema, artifact.schema_version});
        if (step == steps().end())
            throw InputError(fmt::format("{}: schema {}/{} is older than this build reads ({}/{}): make the file again",
                                         path.string(), artifact.schema, artifact.schema_version, artifact.schema,
                                         newest));
        const int next = artifact.schema_version + 1;
        artifact = step->second(std::move(artifact));
        artifact.schema_version = next;
        artifact.metadata.erase("quoin.payload");
    }
    if (artifact.schema_version < 1)
        throw InputError(fmt::format("{}: schema version {} does not exist", path.string(), artifact.schema_version));
    return artifact;
}

} // namespace quoin
