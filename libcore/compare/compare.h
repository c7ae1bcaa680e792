// How far two artifacts of one schema are from each other, in the terms of that schema: planes by angle and offset,
// surfaces by distance, texture pages by PSNR, poses by rotation and translation, figures by value.
#pragma once

#include "artifact/artifact.h"

#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

struct Comparison {
    bool is_equal = false;          // the tensors are equal, byte for byte
    std::vector<std::string> lines; // what differs, for a person
};

// Throws InputError when either cannot be read or they are of different schemas.
Comparison compare_artifacts(const std::filesystem::path& first, const std::filesystem::path& second);

} // namespace quoin
