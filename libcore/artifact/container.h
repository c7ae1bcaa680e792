// The container as a file, for the store.
#pragma once

#include "artifact/artifact.h"

#include <filesystem>

namespace quoin {

// Writes a file that is temporary itself, and syncs it; errors name `final_path`, as which it will be published.
// Returns the payload.
std::string write_artifact_in_place(const std::filesystem::path& temporary, const Artifact& artifact,
                                    const std::filesystem::path& final_path);

// True when the file is as long as its own header says; its contents are not read. False when it is no artifact.
bool is_complete_artifact(const std::filesystem::path& path);

} // namespace quoin
