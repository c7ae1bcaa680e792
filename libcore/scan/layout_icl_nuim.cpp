// ICL-NUIM in its TUM-compatible form: rgb/N.png, depth/N.png, associations.txt; frame numbers take the place of time.
// The trajectory is groundtruth.txt, or livingRoom0.gt.freiburg as the data set itself names it.
#include "base/error.h"
#include "scan/associations.h"
#include "scan/layout.h"
#include "scan/published.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace fs = std::filesystem;
namespace {

fs::path trajectory_of(const fs::path& folder)
{
    if (fs::is_regular_file(folder / "groundtruth.txt")) return folder / "groundtruth.txt";
    std::vector<fs::path> candidates;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().ends_with(".gt.freiburg")) candidates.push_back(entry.path());
    return candidates.empty() ? fs::path() : *std::ranges::min_element(candidates);
}

// Is every time stamp the frame number that the file is named after?
bool numbers_frames(const std::vector<std::vector<std::string>>& associations)
{
    return !associations.empty() && std::ranges::all_of(associations, [](const std::vector<std::string>& row) {
        return row.size() >= 4 && fs::path(row[1]).stem() == row[0] && row[0].find('.') == std::string::npos;
    });
}

bool is_icl_nuim(const fs::path& folder)
{
    const fs::path list = folder / "associations.txt";
    return fs::is_regular_file(list) && !trajectory_of(folder).empty() && numbers_frames(read_table(list));
}

Listing read_icl_nuim(const fs::path& folder, double)
{
    constexpr double same_number = 0.5;
    Listing listing;
    apply(kIclNuim, listing);
    listing.frames = read_associations(folder, listing.absent);
    // A pose belongs to its own number only: interpolating would fill the frames without one.
    set_poses(listing.frames, trajectory_of(folder), same_number);
    for (ListedFrame& frame : listing.frames)
        frame.time /= kFrameRate;
    return listing;
}

} // namespace

const LayoutReader kIclNuimReader{
    Layout::IclNuim, "ICL-NUIM (TUM form)",
    "associations.txt whose times are frame numbers, and groundtruth.txt or *.gt.freiburg", is_icl_nuim, read_icl_nuim};

} // namespace quoin
