#include "mesh/plane_fit.h"

#include "base/parallel.h"
#include "geometry/moments.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace quoin {
namespace {

constexpr double kDeviationPerMedian = 1.4826; // of a normal distribution

// Faces of every cluster, ascending.
struct ClusterFaces {
    std::vector<std::uint32_t> first;
    std::vector<FaceId> face;
    std::span<const FaceId> of(std::size_t plane) const
    {
        return {face.data() + first[plane], first[plane + 1] - first[plane]};
    }
};

ClusterFaces group_faces(const std::vector<PlaneId>& face_plane, std::size_t planes)
{
    ClusterFaces groups{std::vector<std::uint32_t>(planes + 1, 0), std::vector<FaceId>(face_plane.size())};
    for (const PlaneId plane : face_plane)
        ++groups.first[plane + 1];
    for (std::size_t p = 0; p < planes; ++p)
        groups.first[p + 1] += groups.first[p];
    std::vector<std::uint32_t> next(groups.first.begin(), groups.first.end() - 1);
    for (FaceId f = 0; f < face_plane.size(); ++f)
        groups.face[next[face_plane[f]]++] = f;
    return groups;
}

// One cluster, in coordinates about its first vertex.
class Fitter {
public:
    Fitter(const TriangleMesh& mesh, std::span<const FaceId> faces)
        : mesh_(mesh), faces_(faces), origin_(corner(mesh, faces[0], 0))
    {
    }

    Plane fit(const RobustFit& options) const
    {
        Plane plane = weighted_plane([](FaceId) { return 1.0; });
        std::vector<double> distances(faces_.size());
        for (int round = 0; round < options.rounds; ++round) {
            const double cutoff = options.tukey * deviation(plane, distances);
            if (!(cutoff > 0.0)) break; // half of the faces lie in the plane exactly
            plane = weighted_plane([&](FaceId f) {
                const double ratio = std::min(1.0, std::abs(plane.signed_distance(centroid(f))) / cutoff);
                return (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
            });
        }
        if (plane.normal.dot(facing()) < 0.0) plane = plane.flipped();
        plane.offset -= plane.normal.dot(origin_);
        return plane;
    }

private:
    Eigen::Vector3d point(FaceId f, int k) const { return corner(mesh_, f, k) - origin_; }
    Eigen::Vector3d centroid(FaceId f) const { return (point(f, 0) + point(f, 1) + point(f, 2)) / 3.0; }

    template <class Weight>
    Plane weighted_plane(const Weight& weight_of) const
    {
        Moments sum;
        for (const FaceId f : faces_) {
            const double weight = weight_of(f);
            if (weight <= 0.0) continue;
            Moments face = triangle_moments(point(f, 0), point(f, 1), point(f, 2));
            face.area *= weight;
            face.first *= weight;
            face.second *= weight;
            sum += face;
        }
        return fit_plane(sum);
    }

    double deviation(const Plane& plane, std::vector<double>& distances) const
    {
        for (std::size_t i = 0; i < faces_.size(); ++i)
            distances[i] = std::abs(plane.signed_distance(centroid(faces_[i])));
        const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
        std::nth_element(distances.begin(), middle, distances.end());
        return kDeviationPerMedian * *middle;
    }

    Eigen::Vector3d facing() const
    {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const FaceId f : faces_)
            sum += area_vector(mesh_, f);
        return sum;
    }

    const TriangleMesh& mesh_;
    std::span<const FaceId> faces_;
    Eigen::Vector3d origin_;
};

} // namespace

std::vector<Plane> fit_planes(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane, std::size_t planes,
                              const RobustFit& fit)
{
    const ClusterFaces groups = group_faces(face_plane, planes);
    std::vector<Plane> result(planes);
    parallel_for(planes, [&](std::size_t p) {
        if (!groups.of(p).empty()) result[p] = Fitter(mesh, groups.of(p)).fit(fit);
    });
    return result;
}

} // namespace quoin
