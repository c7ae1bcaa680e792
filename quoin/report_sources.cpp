#include "quoin/report_sources.h"

#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "pipeline/run_record.h"
#include "report/report.h"
#include "schema/filled_schema.h"
#include "schema/schema.h"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// The results of the graph's stages of this schema that are there, in order.
std::vector<fs::path> find_results(const Graph& graph, const std::string& scan, const Layout& layout,
                                   const std::string& schema)
{
    std::vector<fs::path> found;
    for (const auto& node : graph.nodes)
        for (const auto& port : node.program.description.outputs) {
            const fs::path path = layout.output(scan, node.name, port.name, port.schema);
            if (port.schema == schema && fs::is_regular_file(path)) found.push_back(path);
        }
    return found;
}

// The scan with the poses that it came with, before a draft corrected them.
std::optional<fs::path> recorded_scan(const std::vector<fs::path>& scans)
{
    return scans.empty() ? std::nullopt : std::optional(scans.front());
}

// How well the photographs agreed before anything was aligned: the draft's alignment knows, where there is one.
std::optional<HeldOutScores> scores_of_draft(const std::vector<fs::path>& alignments)
{
    return alignments.size() > 1 ? read_alignment(alignments.front()).held_out : std::nullopt;
}

template <class T>
std::optional<T> read_if_found(const std::optional<fs::path>& path, T (*read)(const fs::path&))
{
    return path ? std::optional<T>(read(*path)) : std::nullopt;
}

template <class T>
const T* pointer(const std::optional<T>& value)
{
    return value ? &*value : nullptr;
}

std::vector<StageFigures> stage_figures(const Graph& graph, const std::string& scan, const Layout& layout)
{
    std::vector<StageFigures> figures;
    for (const auto& node : graph.nodes)
        if (const auto record = read_run_record(layout.record(scan, node.name)))
            figures.push_back({node.name, record->seconds, record->peak_memory_bytes, record->params_json});
    return figures;
}

std::string digest_of(const Graph& graph, const std::string& scan, const Layout& layout)
{
    std::string text = graph.name + "\n" + scan + "\n" QUOIN_VERSION "\n";
    for (const auto& node : graph.nodes)
        if (const auto record = read_run_record(layout.record(scan, node.name))) {
            text += fmt::format("{} {} {} {}\n", node.name, record->key, record->seconds, record->peak_memory_bytes);
            for (const auto& [port, payload] : record->outputs)
                text += fmt::format("  {} {}\n", port, payload);
        }
    return sha256_hex(text);
}

std::string digest_of_page(const fs::path& page)
{
    constexpr std::size_t kHead = 1024; // the digest stands in the first lines
    std::string head(kHead, '\0');
    std::ifstream file(page, std::ios::binary);
    file.read(head.data(), static_cast<std::streamsize>(kHead));
    return report_digest(head);
}

// The frame that the exported model was brought into, or the world's when there is none.
Rigid model_from_world(const fs::path& summary)
{
    Rigid transform = Rigid::Identity();
    if (!fs::is_regular_file(summary)) return transform;
    const Json json = Json::parse(read_text(summary), nullptr, false);
    const Json rows = json.value(Json::json_pointer("/frame/model_from_world"), Json::array());
    if (rows.size() != 4) return transform;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            transform(r, c) = rows[static_cast<std::size_t>(r)].at(static_cast<std::size_t>(c)).get<double>();
    return transform;
}

// The folder with the scan's images: the scan itself, or the one that the pipeline makes.
fs::path image_root(const Graph& graph, const NamedScan& scan, const Layout& layout)
{
    if (!scan.folder.empty()) return scan.folder;
    for (const auto& node : graph.nodes)
        for (const auto& port : node.program.description.outputs)
            if (port.schema == "folder") return layout.output(scan.name, node.name, port.name, port.schema);
    return {};
}

} // namespace

fs::path report_page(const Layout& layout, const std::string& scan) { return layout.scan_folder(scan) / "report.html"; }

bool write_report(const Graph& graph, const NamedScan& named, const Layout& layout, const fs::path& page)
{
    const std::string digest = digest_of(graph, named.name, layout);
    if (fs::is_regular_file(page) && digest_of_page(page) == digest) return false;
    const auto find = [&](const char* schema) {
        const auto found = find_results(graph, named.name, layout, schema);
        return found.empty() ? std::nullopt : std::optional(found.back());
    };
    const auto textured = read_if_found(find("textured_mesh"), read_textured_mesh);
    const auto planes = textured ? std::nullopt : read_if_found(find("plane_mesh"), read_plane_mesh);
    const auto dense = read_if_found(find("mesh"), read_mesh);
    const auto scan = read_if_found(recorded_scan(find_results(graph, named.name, layout, "scan")), read_scan);
    const auto keyframes = read_if_found(find("keyframes"), read_keyframes);
    const auto alignment = read_if_found(find("alignment"), read_alignment);
    const auto lines = read_if_found(find("lines"), read_lines);
    const auto metrics = read_if_found(find("metrics"), read_metrics);
    const fs::path root = image_root(graph, named, layout), model = layout.scan_folder(named.name) / "model";
    std::optional<ScanImages> images;
    if (scan && fs::is_directory(root)) images.emplace(*scan, root);

    ReportParts parts;
    parts.scan_name = named.name;
    parts.pipeline = graph.name;
    parts.generator = "Quoin " QUOIN_VERSION;
    parts.digest = digest;
    if (fs::exists(model / "model.glb"))
        parts.model_file = (model / "model.glb").lexically_proximate(page.parent_path()).generic_string();
    parts.model_from_world = model_from_world(model / "summary.json");
    parts.textured = pointer(textured);
    parts.planes = pointer(planes);
    parts.dense = pointer(dense);
    parts.scan = pointer(scan);
    parts.images = pointer(images);
    parts.keyframes = pointer(keyframes);
    parts.alignment = pointer(alignment);
    parts.draft_scores = scores_of_draft(find_results(graph, named.name, layout, "alignment"));
    parts.lines = pointer(lines);
    parts.metrics = pointer(metrics);
    if (const auto model_file = find(textured ? "textured_mesh" : "plane_mesh"))
        parts.face_filled = read_face_filled(*model_file);
    parts.stages = stage_figures(graph, named.name, layout);
    write_atomically(page, std::string_view(make_report(parts)));
    return true;
}

} // namespace quoin
