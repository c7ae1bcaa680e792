#include "scan/associations.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

double time_in(const std::string& word, const fs::path& path)
{
    const auto numbers = parse_numbers(word);
    if (numbers.size() == 1 && std::isfinite(numbers[0])) return numbers[0];
    throw InputError(fmt::format("{}: '{}' is no time stamp; expected lines of 'time file'", path.string(), word));
}

// Files of a list that are in the folder, in order of time.
std::vector<TimedFile> read_list(const fs::path& folder, const char* list, AbsentFiles& absent)
{
    std::vector<TimedFile> files;
    for (const auto& row : read_table(folder / list))
        if (row.size() >= 2 && is_present(folder, row[1], absent))
            files.push_back({time_in(row[0], folder / list), row[1]});
    std::ranges::stable_sort(files, {}, &TimedFile::time);
    return files;
}

} // namespace

std::vector<ListedFrame> read_associations(const fs::path& folder, AbsentFiles& absent)
{
    const fs::path path = folder / "associations.txt";
    std::vector<ListedFrame> frames;
    for (const auto& row : read_table(path)) {
        if (row.size() < 4)
            throw InputError(
                fmt::format("{}: a line has {} words; expected 'time file time file'", path.string(), row.size()));
        const std::size_t color = row[1].find("depth") == std::string::npos ? 0 : 2; // where its time and name begin
        const std::size_t depth = 2 - color;
        const bool has_color = is_present(folder, row[color + 1], absent);
        const bool has_depth = is_present(folder, row[depth + 1], absent);
        if (!has_color && !has_depth) continue;
        frames.push_back({.color = has_color ? row[color + 1] : "",
                          .depth = has_depth ? row[depth + 1] : "",
                          .time = time_in(row[has_color ? color : depth], path)});
    }
    std::ranges::stable_sort(frames, {}, &ListedFrame::time);
    return frames;
}

std::vector<ListedFrame> associate_lists(const fs::path& folder, double max_time_gap, AbsentFiles& absent)
{
    const std::vector<TimedFile> colors = read_list(folder, "rgb.txt", absent);
    const std::vector<TimedFile> depths = read_list(folder, "depth.txt", absent);
    const auto partner = associate(colors, depths, max_time_gap);
    std::vector<ListedFrame> frames;
    std::vector<bool> has_color(depths.size(), false);
    for (std::size_t i = 0; i < colors.size(); ++i) {
        frames.push_back(
            {.color = colors[i].name, .depth = partner[i] ? depths[*partner[i]].name : "", .time = colors[i].time});
        if (partner[i]) has_color[*partner[i]] = true;
    }
    for (std::size_t i = 0; i < depths.size(); ++i)
        if (!has_color[i]) frames.push_back({.color = "", .depth = depths[i].name, .time = depths[i].time});
    std::ranges::stable_sort(frames, {}, &ListedFrame::time);
    return frames;
}

void set_poses(std::vector<ListedFrame>& frames, const fs::path& trajectory, double max_time_gap)
{
    const std::vector<TimedPose> poses = read_tum_trajectory(trajectory);
    for (ListedFrame& frame : frames)
        frame.pose = pose_at(poses, frame.time, max_time_gap);
}

} // namespace quoin
