#include "artifact/artifact.h"
#include "base/error.h"
#include "image/image_io.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/tensor_statistics.h"
#include "report/picture.h"
#include "schema/schema.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string better_text(Better better)
{
    constexpr const char* texts[] = {"lower", "higher", ""};
    return texts[static_cast<int>(better)];
}

std::string shape_text(const Tensor& tensor) { return fmt::format("({})", fmt::join(tensor.shape, ", ")); }

// Metadata that is JSON itself is shown as such.
Json parse_or_text(const std::string& text)
{
    Json json = Json::parse(text, nullptr, false);
    return json.is_structured() ? json : Json(text);
}

Json statistics_json(const TensorStatistics& statistics)
{
    Json json = {{"min", statistics.min}, {"max", statistics.max}, {"mean", statistics.mean}};
    if (statistics.not_finite > 0) json["not_finite"] = statistics.not_finite;
    return json;
}

Json artifact_json(const Artifact& artifact, const std::string& payload)
{
    Json json = {{"schema", artifact.schema}, {"schema_version", artifact.schema_version}, {"payload", payload}};
    for (const auto& [key, value] : artifact.metadata)
        if (key != "quoin.payload" && key != "quoin.checksums") json["provenance"][key] = parse_or_text(value);
    json["tensors"] = Json::object();
    for (const auto& [name, tensor] : artifact.tensors) {
        json["tensors"][name] = {{"type", name_of(tensor.type)}, {"shape", tensor.shape}};
        if (const auto statistics = statistics_of(tensor)) json["tensors"][name].update(statistics_json(*statistics));
    }
    return json;
}

Json metrics_json(const Metrics& metrics)
{
    Json json = Json::object();
    for (const auto& metric : metrics)
        json[metric.name] = {{"value", metric.value}, {"unit", metric.unit}, {"better", better_text(metric.better)}};
    return json;
}

void print_tensors(const Artifact& artifact)
{
    fmt::print("\n{:<28} {:<5} {:<18} {:>12} {:>12} {:>12}\n", "tensor", "type", "shape", "min", "mean", "max");
    for (const auto& [name, tensor] : artifact.tensors) {
        fmt::print("{:<28} {:<5} {:<18}", name, name_of(tensor.type), shape_text(tensor));
        const auto statistics = statistics_of(tensor);
        if (statistics)
            fmt::print(" {:>12.6g} {:>12.6g} {:>12.6g}", statistics->min, statistics->mean, statistics->max);
        if (statistics && statistics->not_finite > 0) fmt::print("  ({} not finite)", statistics->not_finite);
        fmt::print("\n");
    }
}

void print_metrics(const Metrics& metrics)
{
    fmt::print("\n{:<44} {:>14} {:<8} {}\n", "figure", "value", "unit", "better");
    for (const auto& metric : metrics)
        fmt::print("{:<44} {:>14.6g} {:<8} {}\n", metric.name, metric.value, metric.unit, better_text(metric.better));
}

void print_header(const fs::path& path, const Artifact& artifact, const std::string& payload)
{
    fmt::print("{}: {}/{}, {}\npayload {}\n", path.string(), artifact.schema, artifact.schema_version,
               bytes_text(fs::file_size(path)), payload);
    for (const auto& [key, value] : artifact.metadata)
        if (key != "quoin.payload" && key != "quoin.checksums") fmt::print("{:<20} {}\n", key, value);
}

struct PictureOptions {
    std::string picture, scan_root, scan;
};

ScanImages images_of(const Scan& scan, const PictureOptions& options, const std::string& schema)
{
    if (options.scan_root.empty())
        throw UsageError(
            fmt::format("a picture of {} shows photographs: add --scan-root DIR, the scan's folder", schema));
    return {scan, options.scan_root};
}

// The scan that an artifact of the same run was made from: given, or OUT/<scan>/import/scan.safetensors beside it.
Scan scan_beside(const fs::path& path, const PictureOptions& options)
{
    const fs::path beside = path.parent_path().parent_path() / "import" / "scan.safetensors";
    const fs::path file = options.scan.empty() ? beside : fs::path(options.scan);
    if (!fs::is_regular_file(file))
        throw UsageError(
            fmt::format("{}: no such file; add --scan FILE, the scan artifact of the same run", file.string()));
    return read_scan(file);
}

ColorImage draw_picture(const fs::path& path, const std::string& schema, const PictureOptions& options)
{
    if (schema == "mesh") return picture_of(read_mesh(path));
    if (schema == "plane_mesh") return picture_of(read_plane_mesh(path));
    if (schema == "textured_mesh") return picture_of(read_textured_mesh(path));
    if (schema == "alignment") return picture_of(read_alignment(path));
    if (schema != "scan" && schema != "keyframes" && schema != "lines")
        throw UsageError(fmt::format("{}: there is no picture of {}", path.string(), schema));
    const Scan scan = schema == "scan" ? read_scan(path) : scan_beside(path, options);
    const ScanImages images = images_of(scan, options, schema);
    if (schema == "scan") return picture_of(scan, images);
    if (schema == "keyframes") return picture_of(read_keyframes(path), images);
    return picture_of(read_lines(path), images);
}

} // namespace

int inspect_verb(const Arguments& arguments)
{
    OptionParser parser("shows what an artifact is, where it comes from and what it holds", "quoin inspect");
    std::string file;
    bool as_json = false;
    parser.option("FILE", file, "an artifact (.safetensors)").required();
    parser.flag("--json", as_json, "as JSON");
    PictureOptions picture;
    parser.option("--picture", picture.picture, "draw it into this PNG file instead");
    parser.option("--scan-root", picture.scan_root, "the scan's folder, for pictures with photographs");
    parser.option("--scan", picture.scan,
                  "the scan artifact, for keyframes and lines (default: ../import/scan.safetensors)");
    if (!parser.parse(arguments)) return 0;
    const fs::path path = file;
    if (!fs::is_regular_file(path)) throw InputError(fmt::format("{}: no such file", file));
    const Artifact artifact = read_artifact(path);
    const std::string payload = read_artifact_header(path).payload;
    if (!picture.picture.empty()) {
        write_png(picture.picture, draw_picture(path, artifact.schema, picture));
        fmt::print("{}\n", picture.picture);
        return 0;
    }
    const bool is_metrics = artifact.schema == "metrics";
    if (as_json) {
        Json json = artifact_json(artifact, payload);
        if (is_metrics) json["metrics"] = metrics_json(read_metrics(path));
        fmt::print("{}\n", json.dump(2));
        return 0;
    }
    print_header(path, artifact, payload);
    if (is_metrics)
        print_metrics(read_metrics(path));
    else
        print_tensors(artifact);
    return 0;
}

} // namespace quoin
