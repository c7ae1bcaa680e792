#include "lines/stretches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

// The part of the 3D segment inside the image and in front of the near plane; every bound is linear in p.
std::optional<std::array<Eigen::Vector3d, 2>> clip_to_view(Eigen::Vector3d a, Eigen::Vector3d b, const Camera& camera)
{
    const double near_plane = RasterizeOptions{}.near_plane;
    const std::array<Eigen::Vector4d, 5> bounds{{
        {0.0, 0.0, 1.0, -near_plane},
        {camera.fx, 0.0, camera.cx, 0.0},
        {-camera.fx, 0.0, camera.width - 1.0 - camera.cx, 0.0},
        {0.0, camera.fy, camera.cy, 0.0},
        {0.0, -camera.fy, camera.height - 1.0 - camera.cy, 0.0},
    }};
    for (const auto& bound : bounds) {
        const double inside_a = bound.dot(a.homogeneous()), inside_b = bound.dot(b.homogeneous());
        if (inside_a < 0.0 && inside_b < 0.0) return {};
        if (inside_a >= 0.0 && inside_b >= 0.0) continue;
        const Eigen::Vector3d cut = a + inside_a / (inside_a - inside_b) * (b - a);
        (inside_a < 0.0 ? a : b) = cut;
    }
    return std::array{a, b};
}

bool shows(const MeshView& view, const StraightBorder& border, const Eigen::Vector3d& p_camera,
           const DetectLinesParams& params)
{
    const Eigen::Vector2d pixel = view.camera.project(p_camera);
    const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
    const double tolerance = params.depth_tolerance + params.relative_depth_tolerance * p_camera.z();
    for (int v = y - params.visible_radius; v <= y + params.visible_radius; ++v)
        for (int u = x - params.visible_radius; u <= x + params.visible_radius; ++u) {
            if (!view.visibility.face.contains(u, v)) continue;
            const FaceId f = view.visibility.face.at(u, v);
            if (f == kNoFace || std::abs(view.visibility.depth.at(u, v) - p_camera.z()) > tolerance) continue;
            const PlaneId plane = view.mesh->face_plane[f];
            if (plane == border.planes[0] || plane == border.planes[1]) return true;
        }
    return false;
}

// Appends the visible stretches of one border: runs of visible sample points.
void add_stretches(const MeshView& view, const std::vector<StraightBorder>& borders, std::size_t index,
                   const DetectLinesParams& params, std::vector<Stretch>& out)
{
    const StraightBorder& border = borders[index];
    const auto clipped =
        clip_to_view(view.camera_from_world * border.ends[0], view.camera_from_world * border.ends[1], view.camera);
    if (!clipped) return;
    const auto& [a, b] = *clipped;
    const double length = (view.camera.project(b) - view.camera.project(a)).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / params.sample_step)));
    const auto point = [&, a = a, b = b](int i) -> Eigen::Vector3d { // evenly spaced in the image, so 1/z is linear
        const double t = static_cast<double>(i) / steps;
        const double weight_a = (1.0 - t) / a.z(), weight_b = t / b.z();
        return (weight_a * a + weight_b * b) / (weight_a + weight_b);
    };
    for (int i = 0; i <= steps;) {
        int end = i;
        while (end <= steps && shows(view, border, point(end), params))
            ++end;
        if (end - i >= 2) {
            const Eigen::Vector3d first = point(i), last = point(end - 1);
            out.push_back({index, {first, last}, {view.camera.project(first), view.camera.project(last)}});
        }
        i = std::max(end, i + 1);
    }
}

// The point of the 3D line p q whose image lies at position `s` [px] along `direction` from `start`.
Eigen::Vector3d point_at(const Stretch& stretch, const Segment& segment, double s, const Camera& camera)
{
    const Eigen::Vector2d direction = (segment.b - segment.a).normalized();
    // direction . (pixel(p) - start) = s, times z, is linear in p.
    const Eigen::Vector3d functional(direction.x() * camera.fx, direction.y() * camera.fy,
                                     direction.dot(Eigen::Vector2d(camera.cx, camera.cy) - segment.a) - s);
    const auto& [p, q] = stretch.p_camera;
    const double at_p = functional.dot(p), at_q = functional.dot(q);
    return p + std::clamp(at_p / (at_p - at_q), 0.0, 1.0) * (q - p);
}

// Mean of |d| along a straight piece on which d runs linearly from d0 to d1.
double mean_distance(double d0, double d1)
{
    const double sum = std::abs(d0) + std::abs(d1);
    if (d0 * d1 >= 0.0) return 0.5 * sum;
    return (d0 * d0 + d1 * d1) / (2.0 * sum);
}

} // namespace

std::vector<Stretch> visible_stretches(const std::vector<StraightBorder>& borders, const MeshView& view,
                                       const DetectLinesParams& params)
{
    std::vector<Stretch> stretches;
    for (std::size_t i = 0; i < borders.size(); ++i)
        add_stretches(view, borders, i, params, stretches);
    return stretches;
}

std::optional<Overlap> overlap_of(const Segment& segment, const Stretch& stretch, const Camera& camera,
                                  const DetectLinesParams& params)
{
    const Eigen::Vector2d along = (segment.b - segment.a).normalized(), across(-along.y(), along.x());
    const Eigen::Vector2d extent = stretch.pixel[1] - stretch.pixel[0];
    const double length = extent.norm();
    if (!(std::abs(extent.dot(along)) >= std::cos(params.match_angle * std::numbers::pi / 180.0) * length) ||
        length <= 0.0)
        return {};
    const double s0 = (stretch.pixel[0] - segment.a).dot(along), s1 = (stretch.pixel[1] - segment.a).dot(along);
    const double low = std::max(0.0, std::min(s0, s1)), high = std::min(segment.length(), std::max(s0, s1));
    if (high - low < params.min_overlap * std::min(segment.length(), length) || high <= low) return {};
    Overlap overlap{{point_at(stretch, segment, low, camera), point_at(stretch, segment, high, camera)}, 0.0};
    overlap.distance = mean_distance((camera.project(overlap.p_camera[0]) - segment.a).dot(across),
                                     (camera.project(overlap.p_camera[1]) - segment.a).dot(across));
    return overlap.distance <= params.match_distance ? std::optional(overlap) : std::nullopt;
}

} // namespace quoin
