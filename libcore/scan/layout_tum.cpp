// TUM RGB-D benchmark: lists with time stamps and a trajectory of a motion capture system.
#include "base/atomic_file.h"
#include "scan/associations.h"
#include "scan/layout.h"
#include "scan/published.h"

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr const char* kGroundTruth = "groundtruth.txt";

bool has(const fs::path& folder, const char* name) { return fs::is_regular_file(folder / name); }

// The sensor is named in the folder's name, or in the comments of its lists ("rgbd_dataset_freiburg3_...").
const PublishedSensor& sensor_of(const fs::path& folder)
{
    const fs::path path = fs::absolute(folder / "").parent_path().lexically_normal();
    std::string text = path.filename().string();
    for (const char* name : {"rgb.txt", "depth.txt", kGroundTruth})
        if (has(folder, name)) text += read_text(folder / name).substr(0, 400); // the comments come first
    const auto names = [&](const char* number) {
        return text.find(std::string("freiburg") + number) != std::string::npos ||
               text.find(std::string("fr") + number + "_") != std::string::npos;
    };
    if (names("1")) return kTumFreiburg1;
    if (names("2")) return kTumFreiburg2;
    return names("3") ? kTumFreiburg3 : kTumDefault;
}

bool is_tum(const fs::path& folder)
{
    return has(folder, kGroundTruth) &&
           (has(folder, "associations.txt") || (has(folder, "rgb.txt") && has(folder, "depth.txt")));
}

Listing read_tum(const fs::path& folder, double max_time_gap)
{
    Listing listing;
    apply(sensor_of(folder), listing);
    listing.depth = listing.color;
    listing.frames = has(folder, "rgb.txt") && has(folder, "depth.txt")
                         ? associate_lists(folder, max_time_gap, listing.absent)
                         : read_associations(folder, listing.absent);
    set_poses(listing.frames, folder / kGroundTruth, max_time_gap);
    return listing;
}

} // namespace

const LayoutReader kTumReader{Layout::Tum, "TUM RGB-D",
                              "groundtruth.txt with rgb.txt and depth.txt, or with associations.txt", is_tum, read_tum};

} // namespace quoin
