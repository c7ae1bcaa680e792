#include "scan/scan.h"

namespace quoin {
namespace {

std::vector<FrameId> frames_with(const Scan& scan, FrameUse use)
{
    std::vector<FrameId> ids;
    for (FrameId id = 0; id < scan.frames.size(); ++id)
        if (scan.frames[id].use == use) ids.push_back(id);
    return ids;
}

} // namespace

std::vector<FrameId> Scan::frames_in_use() const { return frames_with(*this, FrameUse::Used); }
std::vector<FrameId> Scan::frames_held_out() const { return frames_with(*this, FrameUse::HeldOut); }

} // namespace quoin
