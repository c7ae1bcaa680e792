// BundleFusion and 3DLite: numbered frames and a calibration of two cameras in info.txt.
#include "base/atomic_file.h"
#include "base/error.h"
#include "scan/frame_files.h"
#include "scan/layout.h"
#include "scan/layout_text.h"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <sstream>

namespace quoin {
namespace fs = std::filesystem;
namespace {

using Entries = std::map<std::string, std::vector<double>>;

// "key = numbers" lines; text after a key becomes NaN, which nothing here reads.
Entries read_entries(const fs::path& path)
{
    Entries entries;
    std::istringstream lines(read_text(path));
    for (std::string line; std::getline(lines, line);) {
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos) continue;
        const std::size_t end = line.find_last_not_of(" \t", equals - 1);
        entries[line.substr(0, end + 1)] = parse_numbers(std::string_view(line).substr(equals + 1));
    }
    return entries;
}

double scalar(const Entries& entries, const std::string& key)
{
    const auto it = entries.find(key);
    return it == entries.end() || it->second.empty() || !std::isfinite(it->second[0]) ? 0.0 : it->second[0];
}

Eigen::Matrix4d transform(const Entries& entries, const std::string& key)
{
    const auto it = entries.find(key);
    if (it == entries.end()) return Eigen::Matrix4d::Identity();
    const Eigen::Matrix4d matrix = matrix_from(it->second);
    return is_rigid(matrix) ? matrix : Eigen::Matrix4d::Identity();
}

Camera camera(const Entries& entries, const std::string& kind, const fs::path& path)
{
    const std::string key = "m_calibration" + kind + "Intrinsic";
    const auto it = entries.find(key);
    const Eigen::Matrix4d K = it == entries.end() ? matrix_from({}) : matrix_from(it->second);
    if (!K.allFinite() || K(0, 0) == 0.0)
        throw InputError(
            fmt::format("{}: {} is missing or has no 16 numbers; expected fx 0 cx 0 0 fy cy 0 0 0 1 0 0 0 0 1",
                        path.string(), key));
    const std::string lower = kind == "Color" ? "color" : "depth";
    return {static_cast<int>(scalar(entries, "m_" + lower + "Width")),
            static_cast<int>(scalar(entries, "m_" + lower + "Height")),
            K(0, 0),
            K(1, 1),
            K(0, 2),
            K(1, 2)};
}

bool is_bundlefusion(const fs::path& folder)
{
    return fs::is_regular_file(folder / "info.txt") && has_frame_files(folder);
}

Listing read_bundlefusion(const fs::path& folder, double)
{
    const fs::path path = folder / "info.txt";
    const Entries entries = read_entries(path);
    Listing listing;
    listing.frames = list_frame_files(folder);
    listing.color = camera(entries, "Color", path);
    listing.depth = camera(entries, "Depth", path);
    // Extrinsics map a camera's points into the frame that the cameras share.
    listing.depth_from_color =
        transform(entries, "m_calibrationDepthExtrinsic").inverse() * transform(entries, "m_calibrationColorExtrinsic");
    const double steps_a_metre = scalar(entries, "m_depthShift");
    if (steps_a_metre > 0.0) listing.depth_unit = 1.0 / steps_a_metre;
    listing.source = "info.txt";
    return listing;
}

} // namespace

const LayoutReader kBundleFusionReader{Layout::BundleFusion, "BundleFusion / 3DLite",
                                       "info.txt and frame-000000.{color.jpg|png, depth.png, pose.txt}",
                                       is_bundlefusion, read_bundlefusion};

} // namespace quoin
