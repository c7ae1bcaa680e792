#pragma once

#include <filesystem>
#include <string>

namespace quoin {

// Writes a small valid artifact: a floor and a wall as a "mesh" or, in four clusters, as a "plane_mesh". False for
// other schemas.
bool write_sample(const std::filesystem::path& path, const std::string& schema);

} // namespace quoin
