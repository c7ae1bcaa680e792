#pragma once

#include <filesystem>
#include <string>

namespace quoin {

// Reads the artifact by the reader of its schema. Throws InputError saying what is wrong with it.
void check_artifact(const std::filesystem::path& path, const std::string& schema);

} // namespace quoin
