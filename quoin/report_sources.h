// What a report on a scan is made from: the artifacts and records that a run left.
#pragma once

#include "pipeline/graph.h"
#include "pipeline/layout.h"
#include "pipeline/plan.h"

#include <filesystem>
#include <string>

namespace quoin {

// Writes the report on a scan's results to `page`, unless the report that stands there is of the same results; returns
// false then. Throws ImpossibleError when the results hold no model.
bool write_report(const Graph& graph, const NamedScan& scan, const Layout& layout, const std::filesystem::path& page);

// OUT/<scan>/report.html.
std::filesystem::path report_page(const Layout& layout, const std::string& scan);

} // namespace quoin
