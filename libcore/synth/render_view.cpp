#include "synth/render_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kEdgeSamples = 4; // squared, for pixels on an edge
constexpr int kMostSamples = 8; // along a side of a pixel's footprint
constexpr double kNudge = 1e-4; // turns a ray that slips between two triangles

Vector3d ray_direction(const View& view, double x, double y)
{
    return view.world_from_camera.linear() * view.camera.ray({x, y});
}

RayHit cast_closed(const PaintedRoom& room, const View& view, double x, double y)
{
    const Vector3f eye = view.world_from_camera.translation().cast<float>();
    RayHit hit = room.rays.cast(eye, ray_direction(view, x, y).cast<float>());
    if (hit.facet == kNoFacet)
        hit = room.rays.cast(eye, (ray_direction(view, x, y) + Vector3d::Constant(kNudge)).cast<float>());
    return hit;
}

// The nearest facet of every pixel, seen through (x, y) + shift.
Image<RayHit> cast_view(const PaintedRoom& room, const View& view, const Vector2d& shift)
{
    const Camera& camera = view.camera;
    const Vector3f eye = view.world_from_camera.translation().cast<float>();
    Image<RayHit> hits(camera.width, camera.height);
    std::vector<Vector3f> directions(static_cast<std::size_t>(camera.width));
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x)
            directions[static_cast<std::size_t>(x)] = ray_direction(view, x + shift.x(), y + shift.y()).cast<float>();
        room.rays.cast(eye, directions, {hits.row(y), directions.size()});
        for (int x = 0; x < camera.width; ++x)
            if (hits.at(x, y).facet == kNoFacet) hits.at(x, y) = cast_closed(room, view, x + shift.x(), y + shift.y());
    }
    return hits;
}

// A facet as a camera sees it: uv of a pixel is a ratio of affine functions of the ray.
class FacetView {
public:
    FacetView(const Facet& facet, const View& view)
    {
        const Vector3d e1 = facet.corner[1] - facet.corner[0], e2 = facet.corner[2] - facet.corner[0], n = e1.cross(e2);
        const Vector3d to_corner = facet.corner[0] - view.world_from_camera.translation();
        const Eigen::Matrix3d camera_from_world = view.world_from_camera.linear().transpose();
        normal_ = camera_from_world * (n / n.dot(to_corner)); // depth along a ray of unit z is 1 / (normal . ray)
        const Vector3d g1 = e2.cross(n) / n.squaredNorm(), g2 = n.cross(e1) / n.squaredNorm();
        for (int k = 0; k < 2; ++k) {
            const Vector3d gradient = (facet.uv[1][k] - facet.uv[0][k]) * g1 + (facet.uv[2][k] - facet.uv[0][k]) * g2;
            gradient_.row(k) = (camera_from_world * gradient).transpose();
            constant_[k] = facet.uv[0][k] - gradient.dot(to_corner);
        }
    }
    Vector2d uv(const Vector3d& ray) const { return gradient_ * ray / normal_.dot(ray) + constant_; }

private:
    Vector3d normal_;
    Eigen::Matrix<double, 2, 3> gradient_;
    Vector2d constant_;
};

// The last facet's projection: neighbouring pixels mostly show the same one.
class FacetViews {
public:
    FacetViews(const PaintedRoom& room, const View& view) : room_(room), view_(view) {}
    const FacetView& of(std::uint32_t facet)
    {
        if (!seen_ || facet != facet_) seen_.emplace(room_.facets[facet], view_);
        facet_ = facet;
        return *seen_;
    }

private:
    const PaintedRoom& room_;
    const View& view_;
    std::uint32_t facet_ = kNoFacet;
    std::optional<FacetView> seen_;
};

// Mean of the texture over the footprint of a pixel: a grid of samples no wider apart than the texture's detail.
Vector3f sample_footprint(const SurfaceTexture& texture, const FacetView& seen, const Camera& camera,
                          const Vector2d& pixel)
{
    const auto uv = [&](double dx, double dy) { return seen.uv(camera.ray(pixel + Vector2d(dx, dy))); };
    const Vector2d center = uv(0, 0), along_x = uv(0.5, 0) - uv(-0.5, 0), along_y = uv(0, 0.5) - uv(0, -0.5);
    const double length_x = along_x.norm() / texture.texel, length_y = along_y.norm() / texture.texel;
    const double cell =
        std::max({1.0, 0.5 * std::min(length_x, length_y), std::max(length_x, length_y) / kMostSamples});
    const int nx = std::clamp(static_cast<int>(std::ceil(length_x / cell)), 1, kMostSamples);
    const int ny = std::clamp(static_cast<int>(std::ceil(length_y / cell)), 1, kMostSamples);
    Vector3f sum = Vector3f::Zero();
    for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
            sum += texture.sample(center + ((i + 0.5) / nx - 0.5) * along_x + ((j + 0.5) / ny - 0.5) * along_y, cell);
    return sum / static_cast<float>(nx * ny);
}

Vector3f sample_edge(const PaintedRoom& room, const View& view, const Vector2d& pixel)
{
    Vector3f sum = Vector3f::Zero();
    int count = 0;
    for (int j = 0; j < kEdgeSamples; ++j)
        for (int i = 0; i < kEdgeSamples; ++i) {
            const Vector2d at = pixel + Vector2d((i + 0.5) / kEdgeSamples - 0.5, (j + 0.5) / kEdgeSamples - 0.5);
            const RayHit hit = cast_closed(room, view, at.x(), at.y());
            if (hit.facet == kNoFacet) continue;
            const Facet& facet = room.facets[hit.facet];
            sum += room.texture[facet.surface].sample(FacetView(facet, view).uv(view.camera.ray(at)), 1.0);
            ++count;
        }
    return count ? Vector3f(sum / static_cast<float>(count)) : Vector3f::Zero();
}

bool on_edge(const PaintedRoom& room, const Image<RayHit>& hits, int x, int y)
{
    const std::uint32_t facet = hits.at(x, y).facet;
    if (facet == kNoFacet) return true;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            if (!hits.contains(x + dx, y + dy)) continue;
            const std::uint32_t other = hits.at(x + dx, y + dy).facet;
            if (other != facet && (other == kNoFacet || room.facets[other].surface != room.facets[facet].surface))
                return true;
        }
    return false;
}

// Shifts that spread over a pixel (the R2 sequence), so that a moving camera also smooths across its motion.
Vector2d pixel_shift(std::size_t i)
{
    const auto part = [](double x) { return x - std::floor(x) - 0.5; };
    return {part(0.5 + 0.7548776662466927 * static_cast<double>(i)),
            part(0.5 + 0.5698402909980532 * static_cast<double>(i))};
}

} // namespace

ColorField render_color(const PaintedRoom& room, const View& view)
{
    const Image<RayHit> hits = cast_view(room, view, Vector2d::Zero());
    ColorField color(view.camera.width, view.camera.height, Vector3f::Zero());
    FacetViews facets(room, view);
    for (int y = 0; y < color.height; ++y)
        for (int x = 0; x < color.width; ++x) {
            const Vector2d pixel(x, y);
            if (on_edge(room, hits, x, y)) {
                color.at(x, y) = sample_edge(room, view, pixel);
                continue;
            }
            const std::uint32_t facet = hits.at(x, y).facet;
            const SurfaceTexture& texture = room.texture[room.facets[facet].surface];
            color.at(x, y) = sample_footprint(texture, facets.of(facet), view.camera, pixel);
        }
    return color;
}

ColorField render_moving(const PaintedRoom& room, std::span<const View> views)
{
    ColorField mean(views.front().camera.width, views.front().camera.height, Vector3f::Zero());
    for (std::size_t i = 0; i < views.size(); ++i) {
        const Vector2d shift = pixel_shift(i);
        const Image<RayHit> hits = cast_view(room, views[i], shift);
        FacetViews facets(room, views[i]);
        for (int y = 0; y < mean.height; ++y)
            for (int x = 0; x < mean.width; ++x) {
                const RayHit& hit = hits.at(x, y);
                if (hit.facet == kNoFacet) continue;
                const Facet& facet = room.facets[hit.facet];
                const Vector2d uv = facets.of(hit.facet).uv(views[i].camera.ray(Vector2d(x, y) + shift));
                const double texels = hit.distance / views[i].camera.fx / room.texture[facet.surface].texel;
                mean.at(x, y) += room.texture[facet.surface].sample(uv, texels) / static_cast<float>(views.size());
            }
    }
    return mean;
}

ExactDepth render_depth(const PaintedRoom& room, const View& view)
{
    const Image<RayHit> hits = cast_view(room, view, Vector2d::Zero());
    ExactDepth exact{DepthImage(hits.width, hits.height), GrayImage(hits.width, hits.height)};
    for (int y = 0; y < hits.height; ++y)
        for (int x = 0; x < hits.width; ++x) {
            const RayHit& hit = hits.at(x, y);
            if (hit.facet == kNoFacet) continue;
            exact.depth.at(x, y) = hit.distance;
            const Vector3d normal = room.facets[hit.facet].area_vector().normalized();
            exact.cosine.at(x, y) = static_cast<float>(-normal.dot(ray_direction(view, x, y).normalized()));
        }
    return exact;
}

} // namespace quoin
