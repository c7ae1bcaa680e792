#include "report/page_data.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using Json = nlohmann::ordered_json;

Json summary_of(const ReportParts& parts)
{
    const PlaneMesh& model = *parts.model();
    double area = 0.0, filled_area = 0.0;
    for (FaceId f = 0; f < model.mesh.face.size(); ++f) {
        area += face_area(model.mesh, f);
        if (!parts.face_filled.empty() && parts.face_filled[f] != 0) filled_area += face_area(model.mesh, f);
    }
    Json summary{{"vertices", model.mesh.position.size()},
                 {"faces", model.mesh.face.size()},
                 {"planes", model.plane.size()},
                 {"area", area},
                 {"filled_area", filled_area}};
    if (parts.dense) summary["dense_faces"] = parts.dense->face.size();
    if (parts.scan) summary["frames"] = parts.scan->frames.size();
    if (parts.keyframes) summary["keyframes"] = parts.keyframes->frame.size();
    if (parts.alignment && parts.alignment->held_out) {
        const HeldOutScores& scores = *parts.alignment->held_out;
        summary["held_out"] = {{"input", parts.draft_scores ? parts.draft_scores->input : scores.input},
                               {"optimized", scores.optimized},
                               {"is_input_kept", scores.is_input_kept}};
    }
    return summary;
}

Json metrics_of(const Metrics& metrics)
{
    constexpr std::array better{"lower", "higher", "neither"};
    Json list = Json::array();
    for (const Metric& m : metrics)
        list.push_back({{"name", m.name},
                        {"unit", m.unit},
                        {"value", m.value},
                        {"better", better[static_cast<std::size_t>(m.better)]}});
    return list;
}

// Only the terms that were in use.
Json energy_of(const Alignment& alignment)
{
    std::vector<std::size_t> used;
    for (std::size_t e = 0; e < alignment.energy_name.size(); ++e)
        if (std::ranges::any_of(alignment.energy, [&](const auto& row) { return row[e] > 0.0; })) used.push_back(e);
    Json names = Json::array(), rows = Json::array();
    for (const auto e : used)
        names.push_back(alignment.energy_name[e]);
    for (const auto& row : alignment.energy) {
        Json values = Json::array();
        for (const auto e : used)
            values.push_back(row[e]);
        rows.push_back(std::move(values));
    }
    return {{"names", names}, {"rows", rows}};
}

Json sharpness_of(const Keyframes& keyframes)
{
    Json dots = Json::array();
    for (std::size_t i = 0; i < keyframes.blur.size(); ++i) {
        const Dropped reason = keyframes.reason[i];
        const char* group = reason == Dropped::Kept ? "kept" : reason == Dropped::HeldOut ? "held" : "other";
        const float blur = keyframes.blur[i];
        dots.push_back({{"value", std::isfinite(blur) ? Json(blur) : Json()}, {"group", group}});
    }
    return dots;
}

Json stages_of(const std::vector<StageFigures>& stages)
{
    Json list = Json::array();
    for (const StageFigures& stage : stages)
        list.push_back({{"name", stage.name},
                        {"seconds", stage.seconds},
                        {"peak_memory_bytes", stage.peak_memory_bytes},
                        {"params", Json::parse(stage.params_json)}});
    return list;
}

} // namespace

void add_figures(const ReportParts& parts, Json& data)
{
    data["scan"] = parts.scan_name;
    data["pipeline"] = parts.pipeline;
    data["generator"] = parts.generator;
    data["model_file"] = parts.model_file;
    data["summary"] = summary_of(parts);
    data["stages"] = stages_of(parts.stages);
    if (parts.metrics) data["metrics"] = metrics_of(*parts.metrics);
    if (parts.alignment && !parts.alignment->energy.empty()) data["energy"] = energy_of(*parts.alignment);
    if (parts.keyframes) data["sharpness"] = sharpness_of(*parts.keyframes);
}

} // namespace quoin
