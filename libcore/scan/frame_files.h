// The frame-000012.{color.jpg,depth.png,pose.txt} files that several layouts share.
#pragma once

#include "scan/layout.h"

namespace quoin {

bool has_frame_files(const std::filesystem::path& folder);

// Every frame that has a colour image, by number; its time is number / kFrameRate.
std::vector<ListedFrame> list_frame_files(const std::filesystem::path& folder);

} // namespace quoin
