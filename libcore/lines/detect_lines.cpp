#include "lines/detect_lines.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "lines/follow_stretches.h"
#include "lines/match_segments.h"
#include "lines/segments.h"
#include "lines/straight_borders.h"

#include <fmt/format.h>
#include <iterator>
#include <numbers>

namespace quoin {
namespace {

void check(const Keyframes& keyframes, const Scan& scan)
{
    for (const FrameId frame : keyframes.frame)
        if (frame >= scan.frames.size())
            throw InputError(
                fmt::format("keyframes: frame {} is not in the scan, which has {}; select keyframes of this scan",
                            frame, scan.frames.size()));
}

BorderLimits border_limits(const DetectLinesParams& params)
{
    return {params.min_plane_angle * std::numbers::pi / 180.0, params.min_border_length, params.max_border_gap,
            params.max_border_rms};
}

LineMatch to_line_match(const SegmentMatch& match, const StraightBorder& border, FrameId frame)
{
    LineMatch line;
    line.segment << match.segment.a.cast<float>(), match.segment.b.cast<float>();
    line.frame = frame;
    line.planes = border.planes;
    line.end_points = {match.ends[0].cast<float>(), match.ends[1].cast<float>()};
    line.fit_error = static_cast<float>(match.distance);
    return line;
}

std::vector<SegmentMatch> matches_in(const GrayImage& image, const std::vector<Stretch>& stretches,
                                     const MeshView& view, const DetectLinesParams& params)
{
    if (params.method == SegmentMethod::Guided) return follow_stretches(image, stretches, view, params);
    return match_segments(detect_segments(image, params), stretches, view, params);
}

LineMatches lines_of_frame(const ScanImages& images, FrameId frame, const PlaneMesh& mesh,
                           const std::vector<StraightBorder>& borders, const DetectLinesParams& params)
{
    const Camera& camera = images.scan().color;
    const Rigid color_from_world = images.scan().color_from_world(frame);
    const MeshView view{camera, color_from_world, rasterize(mesh.mesh, camera, color_from_world), &mesh};
    const auto stretches = visible_stretches(borders, view, params);
    LineMatches lines;
    for (const auto& match : matches_in(images.gray(frame), stretches, view, params))
        lines.push_back(to_line_match(match, borders[match.border], frame));
    return lines;
}

} // namespace

LineMatches detect_lines(const ScanImages& images, const Keyframes& keyframes, const PlaneMesh& mesh,
                         const DetectLinesParams& params)
{
    check(keyframes, images.scan());
    const auto borders = straight_borders(mesh, border_limits(params));
    std::vector<LineMatches> of_frame(keyframes.frame.size());
    Progress progress("detecting lines", of_frame.size());
    parallel_for(of_frame.size(), [&](std::size_t k) {
        of_frame[k] = lines_of_frame(images, keyframes.frame[k], mesh, borders, params);
        progress.step();
    });
    LineMatches lines;
    for (auto& frame : of_frame)
        std::ranges::move(frame, std::back_inserter(lines));
    log_info(fmt::format("{} segments in {} keyframes match; {} borders between planes are straight", lines.size(),
                         of_frame.size(), borders.size()));
    return lines;
}

} // namespace quoin
