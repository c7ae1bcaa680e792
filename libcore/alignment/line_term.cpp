#include "alignment/line_term.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

namespace quoin {
namespace {

constexpr double kNoLine = 1e-9; // length of the image line's normal below which there is none

std::optional<std::uint32_t> keyframe_index(const Keyframes& keyframes, FrameId frame)
{
    const auto it = std::ranges::lower_bound(keyframes.frame, frame);
    if (it == keyframes.frame.end() || *it != frame) return std::nullopt;
    return static_cast<std::uint32_t>(it - keyframes.frame.begin());
}

bool planes_cross(const AlignmentState& state, const std::array<PlaneId, 2>& id, double min_angle_deg)
{
    if (id[0] == id[1] || std::max(id[0], id[1]) >= state.plane.size()) return false;
    const double sine = state.plane[id[0]].normal.cross(state.plane[id[1]].normal).norm();
    return sine >= std::sin(min_angle_deg * std::numbers::pi / 180.0);
}

Eigen::Matrix3d line_projection(const Camera& c) // K' of moments: l = K' m
{
    Eigen::Matrix3d K;
    K << c.fy, 0, 0, 0, c.fx, 0, -c.fy * c.cx, -c.fx * c.cy, c.fx * c.fy;
    return K;
}

// dr by (relative focal length, cx, cy): through K' alone.
Vector3 by_intrinsics(const Camera& c, const Eigen::RowVector3d& g_l, const Vector3& m)
{
    const Vector3 focal(c.fy * m.x(), c.fx * m.y(),
                        -c.fy * c.cx * m.x() - c.fx * c.cy * m.y() + 2.0 * c.fx * c.fy * m.z());
    return {g_l * focal, -g_l.z() * c.fy * m.x(), -g_l.z() * c.fx * m.y()};
}

// A point on the segment at the depth of the matched border, in the depth camera.
Vector3 expected_point(const AlignmentState& state, std::size_t k, const LineMatch& match, double along)
{
    const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[k];
    const Eigen::Vector3f border =
        match.end_points[0] + static_cast<float>(along) * (match.end_points[1] - match.end_points[0]);
    const double z = (color_from_world * border.cast<double>()).z();
    const Eigen::Vector4d s = match.segment.cast<double>();
    const Eigen::Vector2d pixel = s.head<2>() + along * (s.tail<2>() - s.head<2>());
    return state.color.color_from_depth.inverse() * (state.color.camera.ray(pixel) * z);
}

void add_line_depths(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, const LineMatch& match,
                     std::vector<DepthSample>& samples)
{
    const KeyframeImages& images = scene.images[k];
    const double length = (match.segment.tail<2>() - match.segment.head<2>()).norm();
    const int steps = std::max(1, static_cast<int>(length / scene.params.line_step));
    for (int i = 0; i <= steps; ++i) {
        const Vector3 expected = expected_point(state, k, match, static_cast<double>(i) / steps);
        if (expected.z() < scene.params.min_depth || expected.z() > scene.params.max_depth) continue;
        const Eigen::Vector2d u = scene.depth_camera.project(expected);
        if (!scene.depth_camera.contains(u)) continue;
        const int x = static_cast<int>(std::lround(u.x())), y = static_cast<int>(std::lround(u.y()));
        const double z = images.depth.at(x, y);
        if (z <= 0.0 || std::abs(z - expected.z()) > scene.params.depth_gate) continue;
        const Eigen::Vector3f p = (scene.depth_camera.ray({x, y}) * z).cast<float>();
        for (const PlaneId plane : match.planes)
            samples.push_back({p, plane, static_cast<float>(1.0 / scene.depth_sigma(z))});
    }
}

} // namespace

std::vector<LineObservation> line_observations(const AlignmentScene& scene, const AlignmentState& state,
                                               const Keyframes& keyframes, const LineMatches& lines)
{
    std::vector<LineObservation> observations;
    for (const LineMatch& match : lines) {
        const auto k = keyframe_index(keyframes, match.frame);
        if (!k || !planes_cross(state, match.planes, scene.params.min_line_angle)) continue;
        const Eigen::Vector4d s = match.segment.cast<double>();
        observations.push_back({*k, match.planes, {s.head<2>(), s.tail<2>()}});
    }
    return observations;
}

// Pluecker line (d, m) of two planes, algorithms of section "line term": d = n_a x n_b, m = w_a n_b - w_b n_a, in the
// camera d_c = R d, m_c = R m + t x d_c; image line l = K' m_c; r = l . e / |l_xy|.
LineRow line_row(const AlignmentState& state, const LineObservation& line, std::size_t end)
{
    const CenteredPlane &a = state.plane[line.plane[0]], &b = state.plane[line.plane[1]];
    const double w_a = a.plane().offset, w_b = b.plane().offset;
    const Rigid& C = state.color.color_from_depth;
    const Rigid color_from_world = C * state.camera_from_world[line.frame];
    const Eigen::Matrix3d R = color_from_world.linear();
    const Vector3 d = R * a.normal.cross(b.normal);
    const Vector3 m = R * (w_a * b.normal - w_b * a.normal) + Vector3(color_from_world.translation()).cross(d);
    const Eigen::Matrix3d K = line_projection(state.color.camera);
    const Vector3 l = K * m, e(line.end[end].x(), line.end[end].y(), 1.0);
    const double length = l.head<2>().norm();
    LineRow row;
    if (!(length > kNoLine)) return row;

    row.residual = l.dot(e) / length;
    const Eigen::RowVector3d g_l = (e - Vector3(l.x(), l.y(), 0.0) * (row.residual / length)).transpose() / length;
    const Eigen::RowVector3d g_m = g_l * K, g_m_world = g_m * R;
    const Eigen::RowVector3d g_d_world = g_m * skew(color_from_world.translation()) * R;
    const Vector3 by_turn = -(g_m * skew(m)).transpose(), by_shift = -(g_m * skew(d)).transpose();
    row.calibration.head<6>() = twist(by_turn, by_shift);
    row.calibration.tail<3>() = by_intrinsics(state.color.camera, g_l, m);
    // A step of the depth camera is a step of the colour camera: omega_c = R_C omega, v_c = R_C v + t_C x omega_c.
    const Vector3 turn_about_depth = by_turn - Vector3(C.translation()).cross(by_shift);
    row.pose = twist(C.linear().transpose() * turn_about_depth, C.linear().transpose() * by_shift);

    const double dw_a = g_m_world * b.normal, dw_b = -g_m_world * a.normal;
    const Vector3 dn_a = (-w_b * g_m_world - g_d_world * skew(b.normal)).transpose() - dw_a * a.center;
    const Vector3 dn_b = (w_a * g_m_world + g_d_world * skew(a.normal)).transpose() - dw_b * b.center;
    row.plane[0].head<2>() = a.tangents().transpose() * dn_a;
    row.plane[0].z() = dw_a;
    row.plane[1].head<2>() = b.tangents().transpose() * dn_b;
    row.plane[1].z() = dw_b;
    return row;
}

DepthSamples line_depths(const AlignmentScene& scene, const AlignmentState& state, const Keyframes& keyframes,
                         const LineMatches& lines)
{
    std::vector<std::vector<DepthSample>> of_frame(scene.frames());
    for (const LineMatch& match : lines) {
        const auto k = keyframe_index(keyframes, match.frame);
        if (!k || scene.images[*k].depth.empty() || !planes_cross(state, match.planes, scene.params.min_line_angle))
            continue;
        add_line_depths(scene, state, *k, match, of_frame[*k]);
    }
    DepthSamples result;
    for (std::uint32_t k = 0; k < of_frame.size(); ++k)
        result.add(k, std::move(of_frame[k]));
    return result;
}

std::vector<LineObservation> lines_within(const std::vector<LineObservation>& lines, const AlignmentState& state,
                                          double max_distance)
{
    std::vector<LineObservation> near;
    std::ranges::copy_if(lines, std::back_inserter(near), [&](const LineObservation& line) {
        return std::abs(line_row(state, line, 0).residual) <= max_distance &&
               std::abs(line_row(state, line, 1).residual) <= max_distance;
    });
    return near;
}

std::vector<double> line_costs(const AlignmentState& state, const std::vector<LineObservation>& lines, double sigma,
                               double huber)
{
    std::vector<double> cost(lines.size(), 0.0);
    for (std::size_t i = 0; i < lines.size(); ++i)
        for (const std::size_t end : {0, 1})
            cost[i] += huber_cost(line_row(state, lines[i], end).residual / sigma, huber);
    return cost;
}

} // namespace quoin
