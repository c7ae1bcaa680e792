#pragma once

#include "artifact/artifact.h"

#include <filesystem>

namespace quoin {

// Brings an artifact of an older schema version up to `newest`, one registered step a version. Throws InputError naming
// the path when a step is missing. Schemas are at version 1 until a migration is added to the table in migration.cpp.
Artifact migrate(Artifact artifact, int newest, const std::filesystem::path& path);

} // namespace quoin
