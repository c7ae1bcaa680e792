#include "simplify/curve_fit.h"

#include "geometry/units.h"
#include "mesh/creases.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace quoin {
namespace {

// From the nearest point of the segment ab to p.
Eigen::Vector3d offset_from_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
    const Eigen::Vector3d ab = b - a;
    const double length = ab.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
    return p - a - t * ab;
}

} // namespace

CurveFit::OneOrTwoPlanes CurveFit::planes_of(const Curve& curve) const
{
    const Plane& first = planes_.plane[curve.planes[0]];
    if (curve.planes[1] == kNoPlane) return {{first, first}, 1};
    return {{first, planes_.plane[curve.planes[1]]}, 2};
}

void CurveFit::add_quadrics(const Curve& c, std::vector<Quadric>& quadric) const
{
    const auto planes = planes_of(c);
    std::uint32_t owner = c.head; // the slot that is left and stands for those before the next one
    std::uint32_t s = c.head;
    for (std::uint32_t i = 0; i < curves_.edges(c); ++i) {
        const std::uint32_t t = curves_.after(c, s);
        if (curves_.left(s)) owner = s;
        const Eigen::Vector3d a = curves_.point[s], edge = curves_.point[t] - a;
        const double weight = 0.5 * edge.squaredNorm();
        if (weight > 0.0) {
            Quadric q = Quadric::of_line(a, edge.normalized(), params_.line_weight * weight);
            for (const Plane& plane : std::span<const Plane>(planes))
                q += Quadric::of_plane(plane, params_.plane_weight * weight);
            quadric[owner] += q + Quadric::of_point(a, params_.point_weight * weight);
            quadric[curves_.left(t) ? t : owner] +=
                q + Quadric::of_point(curves_.point[t], params_.point_weight * weight);
        }
        s = t;
    }
}

Eigen::Vector3d CurveFit::target(std::uint32_t s, std::uint32_t t, const std::vector<Quadric>& quadric) const
{
    if (corner(s)) return position(s);
    if (corner(t)) return position(t);
    const Eigen::Vector3d middle = 0.5 * (position(s) + position(t));
    const Eigen::Vector3d x = (quadric[s] + quadric[t]).minimizer(middle);
    const PlaneMeeting line = meet_planes(x, planes_of(curve(s)), radians(params_.crease_angle));
    return line.rank == 2 && (line.point - x).norm() <= params_.snap_distance ? line.point : x;
}

double CurveFit::cost(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x,
                      const std::vector<Quadric>& quadric) const
{
    const double cost = (corner(s) ? 0.0 : quadric[s](x)) + (corner(t) ? 0.0 : quadric[t](x));
    return std::max(cost, 0.0);
}

// The polyline goes on for a vertex at both ends, for these have moved from their own dense points.
bool CurveFit::fits(std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x,
                    const std::vector<float>* tolerance) const
{
    const Curve& c = curve(s);
    const std::uint32_t from = corner(s) ? s : curves_.previous[s], to = corner(t) ? t : curves_.next[t];
    const std::uint32_t ahead = corner(from) ? from : curves_.previous[from],
                        behind = corner(to) ? to : curves_.next[to];
    const std::array<Eigen::Vector3d, 5> line{position(ahead), position(from), x, position(to), position(behind)};
    for (std::uint32_t i = from;; i = curves_.after(c, i)) {
        Eigen::Vector3d nearest = offset_from_segment(curves_.point[i], line[0], line[1]);
        for (std::size_t k = 1; k + 1 < line.size(); ++k) {
            const Eigen::Vector3d offset = offset_from_segment(curves_.point[i], line[k], line[k + 1]);
            if (offset.squaredNorm() < nearest.squaredNorm()) nearest = offset;
        }
        if (!within_error(nearest, c, tolerance ? static_cast<double>((*tolerance)[i]) : 1.0)) return false;
        if (i == to) return true;
    }
}

bool CurveFit::within_error(const Eigen::Vector3d& offset, const Curve& curve, double tolerance) const
{
    if (curve.planes[1] == kNoPlane) return offset.norm() <= tolerance * params_.max_open_error;
    for (const PlaneId p : curve.planes)
        if (std::abs(planes_.plane[p].normal.dot(offset)) > tolerance * params_.max_error) return false;
    return offset.norm() <= tolerance * params_.max_border_shift;
}

} // namespace quoin
