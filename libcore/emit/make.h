// A pipeline on several scans as a Makefile: one rule a stage, % stands for the scan. GNU make and the stage
// executables are all that it needs.
#pragma once

#include "emit/rules.h"

namespace quoin {

// Throws UsageError for names that a Makefile cannot hold.
std::string make_text(const Emission& emission);

} // namespace quoin
