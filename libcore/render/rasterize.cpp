#include "render/rasterize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace quoin {
namespace {

// Notation: N the triangle's normal and v a corner, both in camera coordinates. For the ray r(u) of pixel u the depth
// is z = N.v / N.r(u), so that 1/z = a x + b y + c is affine in the pixel and exact at any tilt.
struct InverseDepth {
    double a, b, c;
    float nearest, farthest; // bounds of 1/z over the clipped triangle: rounding at its edges must not extrapolate
};

// A triangle clipped at the near plane: a convex polygon of three or four pixels.
struct Polygon {
    std::array<Eigen::Vector2d, 4> corner;
    int size = 0;
};

// Leftmost and rightmost crossing of every row with the polygon.
struct Spans {
    std::vector<double> left, right; // one per row [px]
    int first = 0, last = -1;        // rows in use
};

// What is filled while rendering: 1/z grows towards the camera, 0 is infinitely far.
struct Target {
    Image<FaceId> face;
    Image<float> inverse_depth;
};

using Corners = std::array<Eigen::Vector3d, 3>; // in camera coordinates [m]

// What a corner tells of the faces that have it.
enum Corner : std::uint8_t {
    kBeyondLeft = 1,
    kBeyondRight = 2,
    kBeyondTop = 4,
    kBeyondBottom = 8,
    kBehind = 16, // the near plane
    kNotFinite = 32
};

// Vertices in camera coordinates [m]; most faces fall to what their corners tell, and are not looked at further.
struct CameraVertices {
    std::vector<Eigen::Vector3d> p_camera;
    std::vector<std::uint8_t> corner;
};

// Beyond a border of the image means by more than a pixel, so that rounding plays no part. The sides are linear in the
// corners: if all are beyond one, then so is what of the triangle is before the camera.
CameraVertices to_camera(const TriangleMesh& mesh, const Camera& camera, const Rigid& camera_from_world,
                         double near_plane)
{
    const double left = camera.cx + 1.0, right = camera.width - camera.cx;
    const double top = camera.cy + 1.0, bottom = camera.height - camera.cy;
    CameraVertices vertices;
    vertices.p_camera.resize(mesh.position.size());
    vertices.corner.resize(mesh.position.size());
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
        const Eigen::Vector3d p = camera_from_world * mesh.position[i].cast<double>();
        const double x = camera.fx * p.x(), y = camera.fy * p.y(), z = p.z();
        vertices.p_camera[i] = p;
        vertices.corner[i] = static_cast<std::uint8_t>(
            (x + left * z < 0.0 ? kBeyondLeft : 0) | (x - right * z > 0.0 ? kBeyondRight : 0) |
            (y + top * z < 0.0 ? kBeyondTop : 0) | (y - bottom * z > 0.0 ? kBeyondBottom : 0) |
            (z <= near_plane ? kBehind : 0) | (p.allFinite() ? 0 : kNotFinite));
    }
    return vertices;
}

bool may_show(const CameraVertices& vertices, const Face& f)
{
    const unsigned a = vertices.corner[f[0]], b = vertices.corner[f[1]], c = vertices.corner[f[2]];
    return (a & b & c) == 0 && ((a | b | c) & kNotFinite) == 0;
}

bool faces_away(const Corners& v) { return !((v[1] - v[0]).cross(v[2] - v[0]).dot(v[0]) < 0.0); }

// Where the edge crosses the near plane. Always computed from the inner end, so that two triangles that share the edge
// get the same point and no gap opens between them.
Eigen::Vector3d at_near_plane(const Eigen::Vector3d& inside, const Eigen::Vector3d& outside, double near_plane)
{
    Eigen::Vector3d p = inside + (inside.z() - near_plane) / (inside.z() - outside.z()) * (outside - inside);
    p.z() = near_plane;
    return p;
}

Polygon clip_and_project(const Corners& v, const Camera& camera, double near_plane)
{
    Polygon polygon;
    const auto add = [&](const Eigen::Vector3d& p) {
        polygon.corner[static_cast<std::size_t>(polygon.size++)] = camera.project(p);
    };
    for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3d &p = v[k], &q = v[(k + 1) % 3];
        const bool p_inside = p.z() >= near_plane, q_inside = q.z() >= near_plane;
        if (p_inside) add(p);
        if (p_inside && !q_inside) add(at_near_plane(p, q, near_plane));
        if (!p_inside && q_inside) add(at_near_plane(q, p, near_plane));
    }
    return polygon;
}

// Empty for a triangle seen edge-on or without area: it covers no pixel.
std::optional<InverseDepth> inverse_depth(const Corners& v, const Camera& camera, double near_plane)
{
    const Eigen::Vector3d N = (v[1] - v[0]).cross(v[2] - v[0]);
    const double height = N.dot(v[0]);
    const Eigen::Vector3d n = N / height; // 1/z = n . r(u)
    if (!n.allFinite()) return std::nullopt;
    const auto [z_min, z_max] = std::minmax({v[0].z(), v[1].z(), v[2].z()});
    const double a = n.x() / camera.fx, b = n.y() / camera.fy;
    return InverseDepth{a, b, n.z() - a * camera.cx - b * camera.cy,
                        static_cast<float>(1.0 / std::max(z_min, near_plane)), static_cast<float>(1.0 / z_max)};
}

// Widens the spans by one edge. Both ends of the edge's rows are included and the edge always runs downwards: pixels on
// an edge that two triangles share belong to both, so none is missed.
void add_edge(Spans& spans, Eigen::Vector2d top, Eigen::Vector2d bottom)
{
    if (top.y() > bottom.y() || (top.y() == bottom.y() && top.x() > bottom.x())) std::swap(top, bottom);
    const int first = static_cast<int>(std::max(std::ceil(top.y()), static_cast<double>(spans.first)));
    const int last = static_cast<int>(std::min(std::floor(bottom.y()), static_cast<double>(spans.last)));
    const double height = bottom.y() - top.y();
    const double slope = height > 0.0 ? (bottom.x() - top.x()) / height : 0.0;
    for (int y = first; y <= last; ++y) {
        const double x = top.x() + (y - top.y()) * slope;
        const auto row = static_cast<std::size_t>(y);
        spans.left[row] = std::min({spans.left[row], x, height > 0.0 ? x : bottom.x()});
        spans.right[row] = std::max({spans.right[row], x, height > 0.0 ? x : bottom.x()});
    }
}

void find_spans(Spans& spans, const Polygon& polygon, int height)
{
    double top = polygon.corner[0].y(), bottom = top;
    for (int k = 1; k < polygon.size; ++k) {
        top = std::min(top, polygon.corner[static_cast<std::size_t>(k)].y());
        bottom = std::max(bottom, polygon.corner[static_cast<std::size_t>(k)].y());
    }
    spans.first = static_cast<int>(std::clamp(std::ceil(top), 0.0, static_cast<double>(height)));
    spans.last = static_cast<int>(std::clamp(std::floor(bottom), -1.0, static_cast<double>(height - 1)));
    for (int y = spans.first; y <= spans.last; ++y) {
        spans.left[static_cast<std::size_t>(y)] = std::numeric_limits<double>::infinity();
        spans.right[static_cast<std::size_t>(y)] = -std::numeric_limits<double>::infinity();
    }
    for (int k = 0; k < polygon.size; ++k)
        add_edge(spans, polygon.corner[static_cast<std::size_t>(k)],
                 polygon.corner[static_cast<std::size_t>((k + 1) % polygon.size)]);
}

// Faces come in ascending order, and only a strictly nearer one replaces: the smaller id wins on equal depth.
void fill(Target& target, const Spans& spans, const InverseDepth& plane, FaceId id)
{
    const double last_column = target.face.width - 1;
    for (int y = spans.first; y <= spans.last; ++y) {
        const auto row = static_cast<std::size_t>(y);
        const int first = static_cast<int>(std::clamp(std::ceil(spans.left[row]), 0.0, last_column + 1.0));
        const int last = static_cast<int>(std::clamp(std::floor(spans.right[row]), -1.0, last_column));
        const auto start = static_cast<float>(plane.a * first + plane.b * y + plane.c);
        const auto step = static_cast<float>(plane.a);
        float* nearest = target.inverse_depth.row(y) + first;
        FaceId* face = target.face.row(y) + first;
        const int count = last - first + 1;
        for (int i = 0; i < count; ++i) {
            const float value = std::clamp(start + step * static_cast<float>(i), plane.farthest, plane.nearest);
            const bool wins = value > nearest[i];
            nearest[i] = wins ? value : nearest[i];
            face[i] = wins ? id : face[i];
        }
    }
}

Visibility to_visibility(Target target)
{
    Visibility result{std::move(target.face), std::move(target.inverse_depth)};
    for (float& value : result.depth.pixels)
        value = value > 0.0f ? 1.0f / value : 0.0f;
    return result;
}

} // namespace

Visibility rasterize(const TriangleMesh& mesh, const Camera& camera, const Rigid& camera_from_world,
                     const RasterizeOptions& options)
{
    const CameraVertices vertices = to_camera(mesh, camera, camera_from_world, options.near_plane);
    Target target{{camera.width, camera.height, kNoFace}, {camera.width, camera.height, 0.0f}};
    Spans spans;
    spans.left.resize(static_cast<std::size_t>(camera.height));
    spans.right.resize(static_cast<std::size_t>(camera.height));
    for (FaceId id = 0; id < mesh.face.size(); ++id) {
        const Face& f = mesh.face[id];
        if (!may_show(vertices, f)) continue;
        const Corners v{vertices.p_camera[f[0]], vertices.p_camera[f[1]], vertices.p_camera[f[2]]};
        if (options.cull_back_faces && faces_away(v)) continue;
        const auto plane = inverse_depth(v, camera, options.near_plane);
        if (!plane) continue;
        find_spans(spans, clip_and_project(v, camera, options.near_plane), camera.height);
        fill(target, spans, *plane, id);
    }
    return to_visibility(std::move(target));
}

} // namespace quoin
