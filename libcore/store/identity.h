// What a stage's key is made of, found in one place: the stage itself and the driver come to the same key by this code.
#pragma once

#include "store/key.h"

#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

// An input as the stage declares it.
struct InputPort {
    std::string name;
    std::string schema;
};

// Schema and payload of what lies at `path`: of an artifact from its header alone, of a folder by its contents
// (`stat_cache` as in folder_digest). Throws InputError when it is missing or is of another schema than the port's.
InputIdentity identify_input(const InputPort& port, const std::filesystem::path& path,
                             const std::filesystem::path& stat_cache);

// The values that enter the key: of the parameters that affect the result and are not at their neutral value.
// `values` holds one of every parameter.
ParamValues key_params(const std::vector<ParamSpec>& params, const ParamValues& values);

std::string versioned_schema(const std::string& schema, int version = 1); // "plane_mesh/1"

} // namespace quoin
