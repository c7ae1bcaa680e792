#include "merge/regularize.h"

#include "geometry/units.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

// With the measured normal m and the axes e_1, e_2 of the plane's faces, its normal is m + d_1 e_1 + d_2 e_2, and d_k
// has the variance regular_depth^2 / l_k, where l_k is the variance of the faces along e_k. A better known plane with
// the normal n and the axes f_1, f_2 asks for (m + d) . n = 0 if they are orthogonal, for (m + d) . f_k = 0 if
// parallel.
namespace quoin {
namespace {

constexpr double kLeastSpread = 1e-12; // [m^2]
constexpr double kParallel = 10.0;     // [deg]

struct Direction {
    Eigen::Vector3d normal;
    std::array<Eigen::Vector3d, 2> axis; // along the plane
    std::array<double, 2> variance{};    // of the normal's tilt along them [rad^2]

    double certainty() const { return 1.0 / std::max(variance[0], variance[1]); }
    // Of the tilt towards a vector.
    double variance_along(const Eigen::Vector3d& v) const
    {
        const double a = axis[0].dot(v), b = axis[1].dot(v);
        return a * a * variance[0] + b * b * variance[1];
    }
};

Direction direction_of(const Plane& plane, const Moments& moments, double depth)
{
    Direction d;
    d.normal = plane.normal;
    const Eigen::Vector3d u = plane.normal.unitOrthogonal();
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << u, plane.normal.cross(u);
    const Eigen::Matrix2d spread =
        tangents.transpose() * moments.central() * tangents / std::max(moments.area, kLeastSpread);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
    for (int k = 0; k < 2; ++k) {
        d.axis[static_cast<std::size_t>(k)] = tangents * axes.eigenvectors().col(k);
        d.variance[static_cast<std::size_t>(k)] = depth * depth / std::max(axes.eigenvalues()[k], kLeastSpread);
    }
    return d;
}

struct DirectionConstraint {
    Eigen::Vector3d orthogonal; // to the normal
    double variance = 0.0;      // of its cosine with the normal
};

// A normal by its own faces and by better known planes, in least squares.
class NormalEstimate {
public:
    NormalEstimate(const Direction& measured, const MergeParams& params)
        : measured_(measured), params_(params), prior_variance_(std::pow(radians(params.regular_angle), 2))
    {
    }

    // Constrains it to be parallel or orthogonal to a known direction, if it is within the uncertainty of both.
    void constrain_by(const Direction& known)
    {
        const std::vector<DirectionConstraint> added = constraints_of(known);
        const bool are_possible = std::all_of(added.begin(), added.end(), [&](const DirectionConstraint& c) {
            const double sigma = std::sqrt(c.variance + measured_.variance_along(c.orthogonal));
            return std::abs(measured_.normal.dot(c.orthogonal)) <= params_.regular_sigmas * sigma;
        });
        if (added.empty() || !are_possible) return;
        constraints_.insert(constraints_.end(), added.begin(), added.end());
        ++references_;
    }

    bool is_constrained() const { return references_ > 0; }

    // All references together weigh as much as one.
    Eigen::Vector3d solve() const
    {
        Eigen::Matrix2d A = Eigen::Vector2d(1.0 / measured_.variance[0], 1.0 / measured_.variance[1]).asDiagonal();
        Eigen::Vector2d b = Eigen::Vector2d::Zero();
        for (const DirectionConstraint& c : constraints_) {
            const Eigen::Vector2d J(measured_.axis[0].dot(c.orthogonal), measured_.axis[1].dot(c.orthogonal));
            const double weight = 1.0 / (c.variance * references_);
            A += weight * J * J.transpose();
            b -= weight * measured_.normal.dot(c.orthogonal) * J;
        }
        const Eigen::Vector2d x = A.ldlt().solve(b);
        return (measured_.normal + x[0] * measured_.axis[0] + x[1] * measured_.axis[1]).normalized();
    }

private:
    std::vector<DirectionConstraint> constraints_of(const Direction& known) const
    {
        const double cosine = std::abs(measured_.normal.dot(known.normal));
        const double most = std::sin(radians(params_.regular_reach));
        if (cosine <= most) return {{known.normal, prior_variance_ + known.variance_along(measured_.normal)}};
        if (cosine < std::sqrt(1.0 - most * most)) return {};
        return {{known.axis[0], prior_variance_ + known.variance[0]},
                {known.axis[1], prior_variance_ + known.variance[1]}};
    }

    const Direction& measured_;
    const MergeParams& params_;
    const double prior_variance_; // of what was meant to be parallel or orthogonal [rad^2]
    std::vector<DirectionConstraint> constraints_;
    int references_ = 0;
};

// Best known first.
std::vector<PlaneId> by_certainty(const std::vector<Direction>& direction)
{
    std::vector<PlaneId> order(direction.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](PlaneId a, PlaneId b) { return direction[a].certainty() > direction[b].certainty(); });
    return order;
}

// The planes whose directions are known so far, and to which others they are references.
class ReferencePlanes {
public:
    ReferencePlanes(const std::vector<Plane>& plane, const std::vector<Moments>& moments,
                    std::span<const std::pair<PlaneId, PlaneId>> neighbours, const MergeParams& params)
        : plane_(plane), moments_(moments), params_(params), beside_(plane.size()), known_(plane.size(), 0)
    {
        for (const auto& [a, b] : neighbours) {
            beside_[a].push_back(b);
            beside_[b].push_back(a);
        }
    }

    void add(PlaneId p)
    {
        known_[p] = 1;
        if (is_large(p)) large_.push_back(p);
    }

    template <class Visit>
    void for_each_reference(PlaneId p, const Visit& visit) const
    {
        for (const PlaneId q : large_)
            visit(q);
        for (const PlaneId q : beside_[p])
            if (known_[q] && !is_large(q)) visit(q);
    }

    // Does the plane lead from one larger plane to another that is parallel, as the side of a board does?
    bool is_step(PlaneId p) const
    {
        const auto larger = [&](PlaneId q) { return known_[q] && moments_[q].area > 2.0 * moments_[p].area; };
        for (const PlaneId a : beside_[p])
            for (const PlaneId b : beside_[p])
                if (a < b && larger(a) && larger(b) && are_apart(a, b)) return true;
        return false;
    }

private:
    bool is_large(PlaneId p) const { return moments_[p].area >= params_.regular_area; }
    bool are_apart(PlaneId a, PlaneId b) const
    {
        return std::abs(plane_[a].normal.dot(plane_[b].normal)) > std::cos(radians(kParallel)) &&
               std::abs(plane_[a].signed_distance(moments_[b].centroid())) > 2.0 * params_.regular_depth;
    }

    const std::vector<Plane>& plane_;
    const std::vector<Moments>& moments_;
    const MergeParams& params_;
    std::vector<std::vector<PlaneId>> beside_;
    std::vector<std::uint8_t> known_;
    std::vector<PlaneId> large_; // and known
};

// Along its length, but not across it.
bool is_half_known(const Direction& direction, const MergeParams& params)
{
    const auto [better, worse] = std::minmax(direction.variance[0], direction.variance[1]);
    const double open = radians(params.regular_open);
    return better < open * open && worse > open * open;
}

} // namespace

std::vector<Plane> regularize(const std::vector<Plane>& plane, const std::vector<Moments>& moments,
                              std::span<const std::pair<PlaneId, PlaneId>> neighbours, const MergeParams& params)
{
    std::vector<Direction> direction;
    for (PlaneId p = 0; p < plane.size(); ++p)
        direction.push_back(direction_of(plane[p], moments[p], params.regular_depth));
    std::vector<Plane> result = plane;
    ReferencePlanes references(result, moments, neighbours, params);
    for (const PlaneId p : by_certainty(direction)) {
        NormalEstimate estimate(direction[p], params);
        if (is_half_known(direction[p], params))
            references.for_each_reference(p, [&](PlaneId q) { estimate.constrain_by(direction[q]); });
        const bool is_step = references.is_step(p);
        references.add(p);
        if (!estimate.is_constrained()) continue;
        const Eigen::Vector3d normal = estimate.solve(), centre = moments[p].centroid();
        const Plane turned{normal, -normal.dot(plane[p].project(centre))};
        const double farther = rms_to_plane(moments[p], turned) - rms_to_plane(moments[p], plane[p]);
        if (!is_step && farther > params.regular_move) continue;
        result[p] = turned;
        direction[p] = direction_of(turned, moments[p], params.regular_depth);
    }
    return result;
}

} // namespace quoin
