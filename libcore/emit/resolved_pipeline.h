#pragma once

#include "emit/rules.h"

#include <string>

namespace quoin {

// The pipeline of a run as one YAML file: everything that parameter sets, settings and `extends` say is in it.
std::string resolved_pipeline(const Emission& emission);

} // namespace quoin
