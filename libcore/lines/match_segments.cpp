#include "lines/match_segments.h"

#include <algorithm>
#include <tuple>

namespace quoin {
namespace {

struct Candidate {
    std::size_t segment, stretch;
    Overlap overlap;
    auto key() const { return std::tuple(overlap.distance, segment, stretch); }
};

// Do two overlaps on one stretch share more than matches may?
bool collide(const Candidate& x, const Candidate& y, const Stretch& stretch, double min_overlap)
{
    const Eigen::Vector3d along = (stretch.p_camera[1] - stretch.p_camera[0]).normalized();
    const auto interval = [&](const Candidate& c) -> std::pair<double, double> { // minmax itself gives references
        return std::minmax(along.dot(c.overlap.p_camera[0]), along.dot(c.overlap.p_camera[1]));
    };
    const auto i = interval(x), j = interval(y);
    const double shared = std::min(i.second, j.second) - std::max(i.first, j.first);
    return shared > (1.0 - min_overlap) * std::min(i.second - i.first, j.second - j.first);
}

// Nearest first; each segment once, each part of a stretch once.
std::vector<Candidate> choose(std::vector<Candidate> candidates, const std::vector<Stretch>& stretches,
                              const DetectLinesParams& params)
{
    std::sort(candidates.begin(), candidates.end(), [](const auto& x, const auto& y) { return x.key() < y.key(); });
    std::vector<Candidate> chosen;
    for (const auto& candidate : candidates) {
        const bool taken = std::ranges::any_of(chosen, [&](const Candidate& other) {
            if (other.segment == candidate.segment) return true;
            return other.stretch == candidate.stretch &&
                   collide(candidate, other, stretches[candidate.stretch], params.min_overlap);
        });
        if (!taken) chosen.push_back(candidate);
    }
    std::sort(chosen.begin(), chosen.end(), [](const auto& x, const auto& y) { return x.segment < y.segment; });
    return chosen;
}

} // namespace

SegmentMatch matched(const Segment& segment, const Stretch& stretch, const Overlap& overlap, const MeshView& view)
{
    const Rigid world_from_camera = view.camera_from_world.inverse();
    return {segment,
            stretch.border,
            {world_from_camera * overlap.p_camera[0], world_from_camera * overlap.p_camera[1]},
            overlap.distance};
}

std::vector<SegmentMatch> match_segments(const std::vector<Segment>& segments, const std::vector<Stretch>& stretches,
                                         const MeshView& view, const DetectLinesParams& params)
{
    std::vector<Candidate> candidates;
    for (std::size_t s = 0; s < segments.size(); ++s)
        for (std::size_t t = 0; t < stretches.size(); ++t)
            if (const auto overlap = overlap_of(segments[s], stretches[t], view.camera, params))
                candidates.push_back({s, t, *overlap});
    std::vector<SegmentMatch> matches;
    for (const auto& chosen : choose(std::move(candidates), stretches, params))
        matches.push_back(matched(segments[chosen.segment], stretches[chosen.stretch], chosen.overlap, view));
    return matches;
}

} // namespace quoin
