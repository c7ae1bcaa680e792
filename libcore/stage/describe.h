// A stage's description of itself: JSON for programs, text for a person.
#pragma once

#include "stage/stage.h"

namespace quoin {

std::string describe_json(const Stage& stage, const std::vector<ParamSpec>& params);
std::string help_text(const Stage& stage, const std::vector<ParamSpec>& params);

std::string implementation_of(const Stage& stage); // as it enters the cache key: "builtin/merge"

} // namespace quoin
