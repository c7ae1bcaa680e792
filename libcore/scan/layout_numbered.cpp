// Numbered images and one pose a row: raw_imgs/0000_*.jpg, depth_imgs/0000_*.png, truth_cam_poses.txt, and the camera
// in a settings file as ORB-SLAM reads it.
#include "base/atomic_file.h"
#include "base/error.h"
#include "scan/layout.h"
#include "scan/layout_text.h"
#include "scan/published.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTruthPoses = "truth_cam_poses.txt";

// "Camera.fx: 535.4" lines. The files begin with "%YAML:1.0", which YAML parsers other than OpenCV's refuse.
std::map<std::string, double> read_settings(const fs::path& path)
{
    std::map<std::string, double> settings;
    std::istringstream lines(read_text(path));
    for (std::string line; std::getline(lines, line);) {
        const std::size_t colon = line.find(':');
        if (colon == std::string::npos || line.starts_with('#') || line.starts_with('%')) continue;
        const auto numbers = parse_numbers(std::string_view(line).substr(colon + 1));
        if (!numbers.empty() && std::isfinite(numbers[0])) settings[line.substr(0, colon)] = numbers[0];
    }
    return settings;
}

void apply_settings(const fs::path& path, Listing& listing)
{
    const auto settings = read_settings(path);
    const auto value = [&](const char* key) {
        const auto it = settings.find(key);
        return it == settings.end() ? 0.0 : it->second;
    };
    if (value("Camera.fx") == 0.0)
        throw InputError(path.string() + ": no Camera.fx in the file; expected the settings of a camera");
    listing.color = {0,
                     0,
                     value("Camera.fx"),
                     value("Camera.fy"),
                     value("Camera.cx"),
                     value("Camera.cy"),
                     value("Camera.k1"),
                     value("Camera.k2")};
    if (value("DepthMapFactor") > 0.0) listing.depth_unit = 1.0 / value("DepthMapFactor");
    listing.source = path.filename().string();
}

std::vector<fs::path> settings_files(const fs::path& folder)
{
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".yaml" || entry.path().extension() == ".yml") paths.push_back(entry.path());
    std::ranges::sort(paths);
    return paths;
}

std::map<long, std::string> images_by_number(const fs::path& folder, const std::string& subfolder)
{
    std::map<long, std::string> images;
    for (const std::string& name : sorted_images(folder, subfolder))
        images.emplace(leading_number(name), name);
    return images;
}

bool is_numbered(const fs::path& folder)
{
    return fs::is_directory(folder / "raw_imgs") && fs::is_directory(folder / "depth_imgs") &&
           fs::is_regular_file(folder / kTruthPoses);
}

Listing read_numbered(const fs::path& folder, double)
{
    Listing listing;
    apply(kTumDefault, listing);
    if (const auto settings = settings_files(folder); !settings.empty()) apply_settings(settings.front(), listing);
    const std::vector<TimedPose> trajectory = read_tum_trajectory(folder / kTruthPoses);
    const auto depths = images_by_number(folder, "depth_imgs");
    for (const auto& [number, color] : images_by_number(folder, "raw_imgs")) {
        ListedFrame frame;
        frame.color = color;
        if (const auto depth = depths.find(number); depth != depths.end()) frame.depth = depth->second;
        if (const auto row = static_cast<std::size_t>(number); row < trajectory.size()) {
            frame.pose = trajectory[row].pose;
            frame.time = trajectory[row].time;
        }
        listing.frames.push_back(std::move(frame));
    }
    return listing;
}

} // namespace

const LayoutReader kNumberedReader{Layout::Numbered, "numbered images",
                                   "raw_imgs/, depth_imgs/, truth_cam_poses.txt and perhaps a .yaml with the camera",
                                   is_numbered, read_numbered};

} // namespace quoin
