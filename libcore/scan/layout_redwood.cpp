// Open3D and Redwood: a folder of colour, one of depth, and a trajectory.log with a 4x4 matrix for every frame.
#include "base/atomic_file.h"
#include "base/error.h"
#include "scan/layout.h"
#include "scan/layout_text.h"
#include "scan/published.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr std::array kColorFolders{"image", "color", "rgb"};
constexpr std::array kIntrinsics{"camera_intrinsic.json", "intrinsic.json"};

std::string color_folder(const fs::path& folder)
{
    const auto it =
        std::ranges::find_if(kColorFolders, [&](const char* name) { return fs::is_directory(folder / name); });
    return it == kColorFolders.end() ? "" : *it;
}

// trajectory.log, or the only other .log file.
fs::path log_of(const fs::path& folder)
{
    if (fs::is_regular_file(folder / "trajectory.log")) return folder / "trajectory.log";
    std::vector<fs::path> logs;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".log") logs.push_back(entry.path());
    return logs.size() == 1 ? logs.front() : fs::path();
}

// Blocks of "a b frame" and 16 numbers. The first number of a block is the frame's place; poses of absent places are
// NaN.
std::vector<Eigen::Matrix4d> read_log(const fs::path& path, std::size_t frames)
{
    constexpr std::size_t block = 19;
    const std::vector<double> numbers = parse_numbers(read_text(path));
    if (numbers.size() < block || numbers.size() % block != 0)
        throw InputError(fmt::format("{}: {} numbers; expected blocks of 19: 3 of the frame, then a 4x4 matrix",
                                     path.string(), numbers.size()));
    std::vector<Eigen::Matrix4d> poses(frames, matrix_from({}));
    for (std::size_t i = 0; i < numbers.size(); i += block)
        if (numbers[i] >= 0.0 && numbers[i] < static_cast<double>(frames))
            poses[static_cast<std::size_t>(numbers[i])] = matrix_from(numbers, i + 3);
    return poses;
}

// Width, height and a column-major 3x3 matrix, as Open3D writes them.
Camera read_intrinsics(const fs::path& path)
{
    const auto json = nlohmann::json::parse(read_text(path), nullptr, false);
    const bool complete =
        json.is_object() && json.contains("intrinsic_matrix") && json["intrinsic_matrix"].is_array() &&
        json["intrinsic_matrix"].size() == 9 &&
        std::ranges::all_of(json["intrinsic_matrix"], [](const auto& value) { return value.is_number(); });
    if (!complete)
        throw InputError(path.string() + ": no 'intrinsic_matrix' of 9 numbers; expected an Open3D pinhole camera");
    const auto size = [&](const char* key) {
        return json.contains(key) && json[key].is_number_integer() ? json[key].get<int>() : 0;
    };
    const auto K = json["intrinsic_matrix"].get<std::vector<double>>();
    return {size("width"), size("height"), K[0], K[4], K[6], K[7]};
}

// Depth of every colour image: the one of its place when there are as many, else the one of its number.
std::vector<std::string> depth_partners(const std::vector<std::string>& colors, const std::vector<std::string>& depths)
{
    if (colors.size() == depths.size()) return depths;
    std::map<long, std::string> by_number;
    for (const std::string& depth : depths)
        by_number.emplace(leading_number(depth), depth);
    std::vector<std::string> partners;
    for (const std::string& color : colors) {
        const auto it = by_number.find(leading_number(color));
        partners.push_back(it == by_number.end() ? "" : it->second);
    }
    return partners;
}

bool is_redwood(const fs::path& folder)
{
    return !color_folder(folder).empty() && fs::is_directory(folder / "depth") && !log_of(folder).empty();
}

Listing read_redwood(const fs::path& folder, double)
{
    Listing listing;
    apply(kPrimeSense, listing);
    for (const char* name : kIntrinsics)
        if (fs::is_regular_file(folder / name)) {
            listing.color = read_intrinsics(folder / name);
            listing.source = name;
        }
    const std::vector<std::string> colors = sorted_images(folder, color_folder(folder));
    const std::vector<std::string> depths = depth_partners(colors, sorted_images(folder, "depth"));
    const std::vector<Eigen::Matrix4d> poses = read_log(log_of(folder), colors.size());
    for (std::size_t i = 0; i < colors.size(); ++i)
        listing.frames.push_back({colors[i], depths[i], poses[i], static_cast<double>(i) / kFrameRate});
    return listing;
}

} // namespace

const LayoutReader kRedwoodReader{Layout::Redwood, "Open3D / Redwood",
                                  "image/ (or color/, rgb/), depth/, trajectory.log and perhaps camera_intrinsic.json",
                                  is_redwood, read_redwood};

} // namespace quoin
