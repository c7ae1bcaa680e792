// 3D Scanner App on an iPhone with LiDAR: a json for every frame, ARKit axes, a small depth image registered to colour.
#include "base/atomic_file.h"
#include "base/error.h"
#include "scan/layout.h"
#include "scan/layout_text.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace fs = std::filesystem;
namespace {

bool is_frame_json(const fs::path& path)
{
    return path.extension() == ".json" && path.filename().string().starts_with("frame_");
}

struct FrameJson {
    std::vector<double> pose;       // 16, row by row
    std::vector<double> intrinsics; // fx 0 cx 0 fy cy 0 0 1
    double time = 0.0;              // [s]
};

FrameJson read_json(const fs::path& path)
{
    const auto json = nlohmann::json::parse(read_text(path), nullptr, false);
    const auto numbers = [&](const char* key) {
        std::vector<double> values;
        if (json.is_object() && json.contains(key) && json[key].is_array())
            for (const auto& value : json[key])
                values.push_back(value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN());
        return values;
    };
    FrameJson frame{numbers("cameraPoseARFrame"), numbers("intrinsics")};
    if (frame.intrinsics.size() != 9)
        throw InputError(path.string() + ": no 'intrinsics' of 9 numbers; expected a frame file of 3D Scanner App");
    if (json.contains("time") && json["time"].is_number()) frame.time = json["time"].get<double>();
    return frame;
}

double middle_of(std::vector<double> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

// The phone refocuses all the time: its intrinsics move by a pixel over a scan. One camera stands for all frames.
Camera median_camera(const std::vector<FrameJson>& frames)
{
    const auto entry = [&](std::size_t index) {
        std::vector<double> values;
        for (const FrameJson& frame : frames)
            values.push_back(frame.intrinsics[index]);
        return middle_of(std::move(values));
    };
    return {0, 0, entry(0), entry(4), entry(2), entry(5)};
}

bool is_scanner_app(const fs::path& folder)
{
    return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                       [](const fs::directory_entry& entry) { return is_frame_json(entry.path()); });
}

Listing read_scanner_app(const fs::path& folder, double)
{
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder))
        if (is_frame_json(entry.path())) paths.push_back(entry.path().filename());
    std::ranges::sort(paths);
    Listing listing;
    std::vector<FrameJson> jsons;
    for (const fs::path& path : paths) {
        const std::string stem = path.stem().string(),
                          depth = "depth_" + stem.substr(std::string("frame_").size()) + ".png";
        if (!is_present(folder, stem + ".jpg", listing.absent)) continue;
        jsons.push_back(read_json(folder / path));
        listing.frames.push_back({stem + ".jpg", is_present(folder, depth, listing.absent) ? depth : "",
                                  matrix_from(jsons.back().pose), jsons.back().time});
    }
    if (!jsons.empty()) listing.color = median_camera(jsons);
    listing.convention.y_up_z_back = true;
    listing.depth_scales_color = true;
    listing.source = "the median of the frames' json files";
    return listing;
}

} // namespace

const LayoutReader kScannerAppReader{Layout::ScannerApp, "3D Scanner App (iPhone LiDAR)",
                                     "frame_00000.{jpg, json} and depth_00000.png", is_scanner_app, read_scanner_app};

} // namespace quoin
