// The run's figures beside the model: OUT/<scan>/model/summary.json holds what the export counted and, for every stage,
// its version, parameters, seconds and peak memory.
#pragma once

#include "pipeline/graph.h"
#include "pipeline/layout.h"

#include <filesystem>
#include <optional>
#include <string>

namespace quoin {

// Adds the stages' run records to the summary of the exported model. Returns its path, or none when the scan has no
// model. A run that found everything in the store writes the same bytes again.
std::optional<std::filesystem::path> write_summary(const Graph& graph, const std::string& scan, const Layout& layout);

} // namespace quoin
