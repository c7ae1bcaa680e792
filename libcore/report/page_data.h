// What the page says in figures, as JSON, and what it draws, as arrays.
#pragma once

#include "report/page_arrays.h"
#include "report/report.h"

#include <nlohmann/json_fwd.hpp>

namespace quoin {

// Counts, metrics, energies, sharpness and stages.
void add_figures(const ReportParts& parts, nlohmann::ordered_json& data);

// Model, dense mesh, lines and cameras in the model frame.
void add_scene(const ReportParts& parts, const ReportLimits& limits, nlohmann::ordered_json& data, PageArrays& arrays);

// Some keyframes with their matched segments.
void add_photographs(const ReportParts& parts, const ReportLimits& limits, nlohmann::ordered_json& data,
                     PageArrays& arrays);

} // namespace quoin
