// The line term E_t: where two planes meet, the image shows a line. By reprojection: the planes' intersection must pass
// through the ends of the detected segment. By depth (the paper): the depth along the segment must lie on both planes.
#pragma once

#include "alignment/observations.h"
#include "mesh/line_matches.h"

#include <array>

namespace quoin {

// A segment of a keyframe and the planes that it divides.
struct LineObservation {
    std::uint32_t frame = 0; // keyframe index
    std::array<PlaneId, 2> plane{};
    std::array<Eigen::Vector2d, 2> end; // [px], colour image
};

// Distance of the projected intersection line to an end of the segment [px], and its derivatives.
struct LineRow {
    double residual = 0.0;
    Twist pose = Twist::Zero();                                     // by (omega, v) of the depth camera
    std::array<Vector3, 2> plane{Vector3::Zero(), Vector3::Zero()}; // by (alpha, s) of both planes
    CalibrationStep calibration = CalibrationStep::Zero();
};

// The matches whose frame is a keyframe and whose planes meet at min_line_angle or more.
std::vector<LineObservation> line_observations(const AlignmentScene& scene, const AlignmentState& state,
                                               const Keyframes& keyframes, const LineMatches& lines);

// Zero where the intersection has no image (parallel planes, or a line through the camera centre).
LineRow line_row(const AlignmentState& state, const LineObservation& line, std::size_t end);

// The same lines by depth: points every line_step px whose measured depth is within depth_gate of the matched border,
// each once per plane.
DepthSamples line_depths(const AlignmentScene& scene, const AlignmentState& state, const Keyframes& keyframes,
                         const LineMatches& lines);

// Those lines whose two ends lie within max_distance [px] of the crease as `state` shows it. A detector also matches
// spines of books, patterns of cloth and the other edge of a board, and at its end a robust cost still pulls to them.
std::vector<LineObservation> lines_within(const std::vector<LineObservation>& lines, const AlignmentState& state,
                                          double max_distance);

// Sum of robust squared residuals of every line, in units of sigma.
std::vector<double> line_costs(const AlignmentState& state, const std::vector<LineObservation>& lines, double sigma,
                               double huber);

} // namespace quoin
