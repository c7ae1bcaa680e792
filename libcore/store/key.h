// The cache key of one stage run: SHA-256 of canonical JSON that names everything the result depends on, and nothing
// else (no path, host, user, time, thread count or output place).
#pragma once

#include "base/param.h"

#include <map>
#include <string>

namespace quoin {

struct InputIdentity {
    std::string schema; // "plane_mesh/1"
    std::string payload;
};

struct KeyParts {
    std::string stage;
    std::string implementation; // "builtin/merge", or a digest of a foreign program
    int impl_version = 1;
    std::map<std::string, std::string> outputs; // port -> "plane_mesh/1"
    ParamValues params;                         // all that affect the result, defaults filled in
    std::map<std::string, InputIdentity> inputs;
};

struct Key {
    std::string json; // canonical
    std::string hex;  // SHA-256 of json
};

Key make_key(const KeyParts& parts);

// Parameters as canonical JSON: sorted names, shortest floats.
std::string params_json(const ParamValues& params);

} // namespace quoin
