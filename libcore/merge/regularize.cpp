#include "merge/regularize.h"

#include "geometry/units.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

// With the measured normal m and the axes e_1, e_2 of the plane's faces, its normal is m + d_1 e_1 + d_2 e_2, and d_k
// has the variance regular_depth^2 / l_k, where l_k is the variance of the faces along e_k. A better known plane with
// the normal n and the axes f_1, f_2 says (m + d) . n = 0 if they are orthogonal, (m + d) . f_k = 0 if parallel.
namespace quoin {
namespace {

constexpr double kLeastSpread = 1e-12; // [m^2]

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

// What better known planes say about a normal.
struct Saying {
    Eigen::Vector3d orthogonal; // to the normal
    double variance;            // of its cosine with the normal
};

class Regularizer {
public:
    Regularizer(const std::vector<Direction>& known, const MergeParams& params)
        : direction_(known), deviation_(radians(params.regular_angle)), params_(params)
    {
    }

    void hear(PlaneId p, PlaneId by)
    {
        const Direction &d = direction_[p], &known = direction_[by];
        const double cosine = std::abs(d.normal.dot(known.normal));
        const double most = std::sin(radians(params_.regular_reach));
        std::vector<Saying> heard;
        if (cosine <= most)
            heard.push_back({known.normal, variance(known, d.normal)});
        else if (cosine >= std::sqrt(1.0 - most * most))
            for (std::size_t k = 0; k < 2; ++k)
                heard.push_back({known.axis[k], deviation_ * deviation_ + known.variance[k]});
        const bool possible = !heard.empty() && std::all_of(heard.begin(), heard.end(), [&](const Saying& s) {
            const double sigma = std::sqrt(s.variance + d.variance_along(s.orthogonal));
            return std::abs(d.normal.dot(s.orthogonal)) <= params_.regular_sigmas * sigma;
        });
        if (!possible) return;
        said_.insert(said_.end(), heard.begin(), heard.end());
        ++speakers_;
    }

    bool silent() const { return speakers_ == 0; }

    // The normal on which all agree best; together those who speak count as one.
    Eigen::Vector3d agreed(PlaneId p) const
    {
        const Direction& d = direction_[p];
        Eigen::Matrix2d A = Eigen::Vector2d(1.0 / d.variance[0], 1.0 / d.variance[1]).asDiagonal();
        Eigen::Vector2d b = Eigen::Vector2d::Zero();
        for (const Saying& s : said_) {
            const Eigen::Vector2d J(d.axis[0].dot(s.orthogonal), d.axis[1].dot(s.orthogonal));
            const double weight = 1.0 / (s.variance * speakers_);
            A += weight * J * J.transpose();
            b -= weight * d.normal.dot(s.orthogonal) * J;
        }
        const Eigen::Vector2d x = A.ldlt().solve(b);
        return (d.normal + x[0] * d.axis[0] + x[1] * d.axis[1]).normalized();
    }

private:
    double variance(const Direction& known, const Eigen::Vector3d& towards) const
    {
        return deviation_ * deviation_ + known.variance_along(towards);
    }

    const std::vector<Direction>& direction_;
    const double deviation_; // [rad]
    const MergeParams& params_;
    std::vector<Saying> said_;
    int speakers_ = 0;
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

} // namespace

std::vector<Plane> regularize(const std::vector<Plane>& plane, const std::vector<Moments>& moments,
                              std::span<const std::pair<PlaneId, PlaneId>> neighbours, const MergeParams& params)
{
    std::vector<Direction> direction;
    for (PlaneId p = 0; p < plane.size(); ++p)
        direction.push_back(direction_of(plane[p], moments[p], params.regular_depth));
    std::vector<std::vector<PlaneId>> beside(plane.size());
    for (const auto& [a, b] : neighbours) {
        beside[a].push_back(b);
        beside[b].push_back(a);
    }
    std::vector<Plane> result = plane;
    std::vector<std::uint8_t> known(plane.size(), 0);
    std::vector<PlaneId> large; // and known
    for (const PlaneId p : by_certainty(direction)) {
        Regularizer regularizer(direction, params);
        for (const PlaneId q : large)
            regularizer.hear(p, q);
        for (const PlaneId q : beside[p])
            if (known[q] && moments[q].area < params.regular_area) regularizer.hear(p, q);
        known[p] = 1;
        if (moments[p].area >= params.regular_area) large.push_back(p);
        if (regularizer.silent()) continue;
        const Eigen::Vector3d normal = regularizer.agreed(p);
        direction[p] = direction_of({normal, 0.0}, moments[p], params.regular_depth);
        result[p] = {normal, plane[p].offset + (plane[p].normal - normal).dot(moments[p].centroid())};
    }
    return result;
}

} // namespace quoin
