// 7-Scenes and 3DMatch: numbered frames; intrinsics in camera-intrinsics.txt, or as published.
#include "base/atomic_file.h"
#include "base/error.h"
#include "scan/frame_files.h"
#include "scan/layout.h"
#include "scan/layout_text.h"
#include "scan/published.h"

#include <cmath>

namespace quoin {
namespace fs = std::filesystem;
namespace {

bool is_seven_scenes(const fs::path& folder) { return has_frame_files(folder); }

Listing read_seven_scenes(const fs::path& folder, double)
{
    Listing listing;
    apply(kKinect7Scenes, listing);
    listing.frames = list_frame_files(folder);
    const fs::path path = folder / "camera-intrinsics.txt";
    if (!fs::is_regular_file(path)) return listing;
    const std::vector<double> K = parse_numbers(read_text(path));
    const bool complete = K.size() >= 9 && std::isfinite(K[0] + K[2] + K[4] + K[5]) && K[0] != 0.0 && K[4] != 0.0;
    if (!complete) throw InputError(path.string() + ": no 3x3 matrix of numbers; expected fx 0 cx 0 fy cy 0 0 1");
    listing.color = {0, 0, K[0], K[4], K[2], K[5]};
    listing.source = "camera-intrinsics.txt";
    return listing;
}

} // namespace

const LayoutReader kSevenScenesReader{
    Layout::SevenScenes, "7-Scenes / 3DMatch",
    "frame-000000.{color.jpg|png, depth.png, pose.txt} and perhaps camera-intrinsics.txt", is_seven_scenes,
    read_seven_scenes};

} // namespace quoin
