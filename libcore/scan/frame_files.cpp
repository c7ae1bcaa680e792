#include "scan/frame_files.h"

#include "scan/layout_text.h"
#include "scan/published.h"

#include <algorithm>

namespace quoin {
namespace fs = std::filesystem;
namespace {

bool is_color(const std::string& name)
{
    return name.starts_with("frame-") && name.find(".color.") != std::string::npos;
}

// The sibling of a colour file, or "" when it is not there.
std::string sibling(const fs::path& folder, const std::string& color, const std::string& ending)
{
    const std::string name = color.substr(0, color.find(".color.")) + ending;
    return fs::is_regular_file(folder / name) ? name : "";
}

} // namespace

bool has_frame_files(const fs::path& folder)
{
    return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                       [](const fs::directory_entry& entry) { return is_color(entry.path().filename().string()); });
}

std::vector<ListedFrame> list_frame_files(const fs::path& folder)
{
    std::vector<std::pair<long, std::string>> colors;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (is_color(name)) colors.emplace_back(number_of(name).value_or(0), name);
    }
    std::ranges::sort(colors);
    std::vector<ListedFrame> frames;
    for (const auto& [number, name] : colors) {
        ListedFrame frame{.color = name,
                          .depth = sibling(folder, name, ".depth.png"),
                          .time = static_cast<double>(number) / kFrameRate};
        const std::string pose = sibling(folder, name, ".pose.txt");
        if (!pose.empty()) frame.pose = read_matrix(folder / pose);
        frames.push_back(std::move(frame));
    }
    return frames;
}

} // namespace quoin
