#include "mesh/plane_fit.h"

#include "base/parallel.h"
#include "geometry/groups.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

namespace quoin {
namespace {

constexpr double kDeviationPerMedian = 1.4826; // of a normal distribution

// A face as a point with a weight.
struct FacePoint {
    Eigen::Vector3f centroid;
    float area;
};

Moments point_moments(const Eigen::Vector3d& p, double weight)
{
    const Eigen::Vector3d q = weight * p;
    Moments moments;
    moments.area = weight;
    moments.first = q;
    moments.second << q.x() * p.x(), q.x() * p.y(), q.x() * p.z(), q.y() * p.y(), q.y() * p.z(), q.z() * p.z();
    return moments;
}

// One cluster, in coordinates about its first vertex.
class Fitter {
public:
    Fitter(const TriangleMesh& mesh, std::span<const FaceId> faces)
        : mesh_(mesh), faces_(faces), origin_(corner(mesh, faces[0], 0)), points_(faces.size())
    {
        const auto gather = [&](std::size_t begin, std::size_t end) { return gathered(begin, end); };
        sums_ = parallel_reduce(faces.size(), kGrain, Sums(), gather, [](Sums a, const Sums& b) { return a += b; });
    }

    // Exact, about the world origin.
    Moments moments() const { return sums_.faces.translated(origin_); }

    Plane fit(const RobustFit& options) const
    {
        Plane plane = fit_plane(sums_.faces);
        for (int round = 0; round < options.rounds; ++round) {
            const double cutoff = options.tukey * deviation(plane);
            if (!(cutoff > 0.0)) break; // half of the faces lie in the plane exactly
            plane = round + 1 < options.rounds ? roughly_reweighted(plane, cutoff) : reweighted(plane, cutoff);
        }
        if (plane.normal.dot(sums_.facing) < 0.0) plane = plane.flipped();
        plane.offset -= plane.normal.dot(origin_);
        return plane;
    }

private:
    struct Sums {
        Moments faces, points;
        Eigen::Vector3d facing = Eigen::Vector3d::Zero();
        Sums& operator+=(const Sums& other)
        {
            faces += other.faces;
            points += other.points;
            facing += other.facing;
            return *this;
        }
    };

    Sums gathered(std::size_t begin, std::size_t end)
    {
        Sums sums;
        for (std::size_t i = begin; i < end; ++i) {
            const FaceId f = faces_[i];
            const Eigen::Vector3d a = point(f, 0), b = point(f, 1), c = point(f, 2);
            const Moments face = triangle_moments(a, b, c);
            points_[i] = {((a + b + c) / 3.0).cast<float>(), static_cast<float>(face.area)};
            sums.faces += face;
            sums.points += point_moments(points_[i].centroid.cast<double>(), points_[i].area);
            sums.facing += (b - a).cross(c - a);
        }
        return sums;
    }

    double distance(const Plane& plane, const FacePoint& point) const
    {
        return std::abs(plane.signed_distance(point.centroid.cast<double>()));
    }

    // Of the faces' distances, from their median; of a large cluster, that of a regular sample.
    double deviation(const Plane& plane) const
    {
        const std::size_t step = (points_.size() + kMedianSample - 1) / kMedianSample;
        std::vector<double> distances;
        distances.reserve(points_.size() / step + 1);
        for (std::size_t i = 0; i < points_.size(); i += step)
            distances.push_back(distance(plane, points_[i]));
        const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
        std::nth_element(distances.begin(), middle, distances.end());
        return kDeviationPerMedian * *middle;
    }

    // Tukey's weight of a face whose centroid is that far off, times its area.
    double weight(const Plane& plane, double cutoff, const FacePoint& point) const
    {
        const double ratio = distance(plane, point) / cutoff;
        return ratio < 1.0 ? (1.0 - ratio * ratio) * (1.0 - ratio * ratio) * point.area : 0.0;
    }

    // How faces spread about their centroids counts with their mean weight: near enough to find the weights.
    Plane roughly_reweighted(const Plane& plane, double cutoff) const
    {
        Moments sum = sum_chunks([&](std::size_t i) {
            return point_moments(points_[i].centroid.cast<double>(), weight(plane, cutoff, points_[i]));
        });
        if (sums_.points.area > 0.0)
            sum.second += sum.area / sums_.points.area * (sums_.faces.second - sums_.points.second);
        return fit_plane(sum);
    }

    Plane reweighted(const Plane& plane, double cutoff) const
    {
        return fit_plane(sum_chunks([&](std::size_t i) {
            const double w = weight(plane, cutoff, points_[i]);
            if (w <= 0.0) return Moments();
            Moments face = face_moments(faces_[i]);
            const double scale = w / face.area;
            face.area = w;
            face.first *= scale;
            face.second *= scale;
            return face;
        }));
    }

    template <class MomentsOf>
    Moments sum_chunks(const MomentsOf& moments_of) const
    {
        const auto sum = [&](std::size_t begin, std::size_t end) {
            Moments moments;
            for (std::size_t i = begin; i < end; ++i)
                moments += moments_of(i);
            return moments;
        };
        return parallel_reduce(points_.size(), kGrain, Moments(), sum, std::plus<>());
    }

    Eigen::Vector3d point(FaceId f, int k) const { return corner(mesh_, f, k) - origin_; }
    Moments face_moments(FaceId f) const { return triangle_moments(point(f, 0), point(f, 1), point(f, 2)); }

    static constexpr std::size_t kGrain = 1 << 13;
    static constexpr std::size_t kMedianSample = 1 << 12;

    const TriangleMesh& mesh_;
    std::span<const FaceId> faces_;
    Eigen::Vector3d origin_;
    std::vector<FacePoint> points_;
    Sums sums_;
};

} // namespace

FittedPlanes fit_planes(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane, std::size_t planes,
                        const RobustFit& fit)
{
    const Groups groups = group_items(face_plane, planes);
    FittedPlanes result{std::vector<Plane>(planes), std::vector<Moments>(planes)};
    parallel_for(planes, [&](std::size_t p) {
        if (groups.of(p).empty()) return;
        const Fitter fitter(mesh, groups.of(p));
        result.plane[p] = fitter.fit(fit);
        result.moments[p] = fitter.moments();
    });
    return result;
}

} // namespace quoin
