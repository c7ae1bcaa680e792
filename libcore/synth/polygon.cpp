#include "synth/polygon.h"

#include "geometry/plane.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace quoin {
namespace {

constexpr double kSameLine = 1e-7;  // [m]; closer to the cutting line counts as on it
constexpr double kLeastArea = 1e-8; // [m^2]; smaller pieces are rounding

// The part of a convex polygon on the negative side of a plane.
Polygon clip(const Polygon& polygon, const Plane& plane)
{
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector3d& a = polygon[i];
        const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
        const double da = plane.signed_distance(a), db = plane.signed_distance(b);
        if (da <= kSameLine) kept.push_back(a);
        const bool crosses = (da > kSameLine && db < -kSameLine) || (da < -kSameLine && db > kSameLine);
        if (crosses) kept.push_back(a + (b - a) * (da / (da - db)));
    }
    return kept.size() >= 3 && polygon_area(kept) > kLeastArea ? kept : Polygon{};
}

} // namespace

double polygon_area(const Polygon& polygon)
{
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 2; i < polygon.size(); ++i)
        sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
    return 0.5 * sum.norm();
}

PolygonCut cut_polygon(const Polygon& polygon, const Polygon& hole, const Eigen::Vector3d& normal)
{
    const Eigen::Vector3d turn = (hole[1] - hole[0]).cross(hole[2] - hole[1]);
    const double side = turn.dot(normal) > 0.0 ? 1.0 : -1.0;
    PolygonCut cut{polygon, {}};
    for (std::size_t i = 0; i < hole.size() && !cut.common.empty(); ++i) {
        const Eigen::Vector3d edge = hole[(i + 1) % hole.size()] - hole[i];
        const Eigen::Vector3d outward = (side * edge.cross(normal)).normalized();
        const Plane border{outward, -outward.dot(hole[i])};
        if (Polygon outside = clip(cut.common, border.flipped()); !outside.empty())
            cut.rest.push_back(std::move(outside));
        cut.common = clip(cut.common, border);
    }
    if (cut.common.empty()) cut.rest = {polygon};
    return cut;
}

} // namespace quoin
