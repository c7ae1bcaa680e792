// A pipeline on several scans as a Ninja file: one rule a stage, one build statement a stage and scan. Ninja and the
// stage executables are all that it needs.
#pragma once

#include "emit/rules.h"

namespace quoin {

// Throws UsageError for names that a Ninja file cannot hold.
std::string ninja_text(const Emission& emission);

} // namespace quoin
