#include "synth/lighting.h"

#include "synth/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kCell = 0.08;        // of the grid [m]
constexpr int kDomeRays = 96;         // towards the rest of the room
constexpr int kLightRays = 6;         // squared, towards each light
constexpr double kAmbient = 0.92;     // light from a far surface, of that on a white one
constexpr double kAmbientReach = 1.2; // surfaces nearer than this give less [m]
constexpr double kLightGain = 6.0;    // of the lamps, against the ambient light
constexpr double kShoulder = 0.30;    // compression of bright places
constexpr double kRayLift = 1e-3;     // of ray origins off their surface [m]

struct SurfacePoint {
    Vector3d position, normal;
};

SurfacePoint locate(const LatheSurface& lathe, const Vector2d& uv)
{
    const std::vector<double> length = lathe.profile_length();
    std::size_t ring = 0;
    while (ring + 2 < length.size() && uv.y() > length[ring + 1])
        ++ring;
    const double t = std::clamp((uv.y() - length[ring]) / std::max(length[ring + 1] - length[ring], 1e-9), 0.0, 1.0);
    const Vector2d along = (lathe.profile[ring + 1] - lathe.profile[ring]).normalized();
    const Vector2d at = lathe.profile[ring] + t * (lathe.profile[ring + 1] - lathe.profile[ring]);
    const double angle = uv.x() / lathe.largest_radius();
    const auto turn = [&](double radius, double height) {
        return Vector3d(radius * std::cos(angle), radius * std::sin(angle), height);
    };
    return {lathe.foot + turn(at.x(), at.y()), turn(-along.y(), along.x())};
}

SurfacePoint locate(const Room& room, std::uint32_t surface, const Vector2d& uv)
{
    if (surface < room.planar.size()) return {room.planar[surface].at(uv), room.planar[surface].plane.normal};
    return locate(room.curved[surface - room.planar.size()], uv);
}

// Light of the lamps: the form factor of each, by stratified shadow rays.
double direct_light(const Room& room, const RayScene& rays, const SurfacePoint& point)
{
    double sum = 0.0;
    for (const AreaLight& light : room.lights) {
        const Vector3d area = 4.0 * light.half_u.cross(light.half_v);
        for (int i = 0; i < kLightRays * kLightRays; ++i) {
            const int column = i % kLightRays, row = i / kLightRays;
            const double u = (column + 0.5) * 2.0 / kLightRays - 1.0, v = (row + 0.5) * 2.0 / kLightRays - 1.0;
            const Vector3d target = light.center + u * light.half_u + v * light.half_v, way = target - point.position;
            const double square = way.squaredNorm(), facing = point.normal.dot(way);
            if (facing <= 0.0 || rays.blocked(point.position.cast<float>(), target.cast<float>())) continue;
            sum += light.strength * facing * std::abs(area.dot(way)) / (std::numbers::pi * square * square + 1e-3);
        }
    }
    return kLightGain * sum / (kLightRays * kLightRays);
}

struct DomeLight {
    double light = 0.0;
    bool buried = false; // the point lies inside a solid
};

DomeLight dome_light(const std::vector<Facet>& facets, const RayScene& rays, const SurfacePoint& point,
                     CounterRandom random)
{
    const Vector3d side = std::abs(point.normal.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
    const Vector3d tangent = side.cross(point.normal).normalized(), other = point.normal.cross(tangent);
    const double turn = random.uniform();
    int behind = 0;
    double sum = 0.0;
    for (int i = 0; i < kDomeRays; ++i) { // cosine-weighted, on a golden spiral
        const double square = (i + 0.5) / kDomeRays, radius = std::sqrt(square);
        const double angle = 2.0 * std::numbers::pi * (turn + i * std::numbers::phi);
        const Vector3d direction =
            radius * (std::cos(angle) * tangent + std::sin(angle) * other) + std::sqrt(1.0 - square) * point.normal;
        const RayHit hit = rays.cast(point.position.cast<float>(), direction.cast<float>());
        if (hit.facet == kNoFacet) continue;
        if (facets[hit.facet].area_vector().dot(direction) > 0.0)
            ++behind;
        else
            sum += std::min(1.0, 0.35 + 0.65 * hit.distance / kAmbientReach);
    }
    return {kAmbient * sum / kDomeRays, 2 * behind > kDomeRays};
}

} // namespace

float LightGrid::at(const Vector2d& uv) const
{
    const double x = std::clamp((uv.x() - corner.x()) / cell.x() - 0.5, 0.0, width - 1.0);
    const double y = std::clamp((uv.y() - corner.y()) / cell.y() - 0.5, 0.0, height - 1.0);
    const int x0 = std::min(static_cast<int>(x), std::max(width - 2, 0)),
              y0 = std::min(static_cast<int>(y), std::max(height - 2, 0));
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    float sum = 0.0f, total = 0.0f;
    const auto add = [&](int ix, int iy, float w) {
        const auto i = static_cast<std::size_t>(std::min(iy, height - 1) * width + std::min(ix, width - 1));
        sum += w * weight[i] * value[i];
        total += w * weight[i];
    };
    add(x0, y0, (1 - fx) * (1 - fy));
    add(x0 + 1, y0, fx * (1 - fy));
    add(x0, y0 + 1, (1 - fx) * fy);
    add(x0 + 1, y0 + 1, fx * fy);
    return sum / total;
}

LightGrid cast_light(const Room& room, const std::vector<Facet>& facets, const RayScene& rays, std::uint32_t surface,
                     const TextureExtent& extent)
{
    const Vector2d size = extent.high - extent.low;
    LightGrid grid;
    grid.width = std::max(1, static_cast<int>(std::ceil(size.x() / kCell)));
    grid.height = std::max(1, static_cast<int>(std::ceil(size.y() / kCell)));
    grid.corner = extent.low;
    grid.cell = {size.x() / grid.width, size.y() / grid.height};
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            const Vector2d uv = grid.corner + grid.cell.cwiseProduct(Vector2d(x + 0.5, y + 0.5));
            SurfacePoint point = locate(room, surface, uv);
            point.position += kRayLift * point.normal;
            const CounterRandom random(surface, RandomPurpose::Light, static_cast<std::uint64_t>(y),
                                       static_cast<std::uint64_t>(x));
            const DomeLight dome = dome_light(facets, rays, point, random);
            const double light = dome.light + direct_light(room, rays, point);
            grid.value.push_back(static_cast<float>(light / (1.0 + kShoulder * light)));
            grid.weight.push_back(dome.buried ? 1e-6f : 1.0f);
        }
    return grid;
}

} // namespace quoin
