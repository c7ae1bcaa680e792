// Lists of colour and depth files with time stamps, in the form of the TUM RGB-D benchmark.
#pragma once

#include "scan/layout.h"
#include "scan/layout_text.h"

namespace quoin {

// Frames of an associations.txt: "time color time depth" lines, or depth first as ICL-NUIM has it. Either image may be
// absent.
std::vector<ListedFrame> read_associations(const std::filesystem::path& folder, AbsentFiles& absent);

// Frames of rgb.txt and depth.txt: each colour image with the closest depth image within `max_time_gap` [s]. Depth
// images that no colour image is near to are frames of their own, which a trajectory can place as well.
std::vector<ListedFrame> associate_lists(const std::filesystem::path& folder, double max_time_gap, AbsentFiles& absent);

// Gives every frame the pose of the trajectory at its time.
void set_poses(std::vector<ListedFrame>& frames, const std::filesystem::path& trajectory, double max_time_gap);

} // namespace quoin
