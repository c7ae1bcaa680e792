// Distances between surfaces by samples that are spread evenly over their area.
#pragma once

#include "geometry/rigid.h"
#include "mesh/triangle_mesh.h"
#include "metrics/nearest.h"

#include <span>
#include <vector>

namespace quoin {

struct SurfaceSample {
    Eigen::Vector3d position, normal;
    Eigen::Vector3d weights; // barycentric
    FaceId face = 0;
};

// Weights of a point on the plane of a face, beyond its edges too; of its first corner when it has no area.
Eigen::Vector3d barycentric(const TriangleMesh& mesh, FaceId face, const Eigen::Vector3d& point);

// `count` points, stratified by area and placed by the R2 sequence; no random numbers. Empty for a mesh without area.
std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, std::size_t count);

// Distance of every point to the surface, `reach` where nothing is nearer [m].
std::vector<double> distances(std::span<const Eigen::Vector3d> points, const NearestItem& surface, double reach);

struct DistanceStatistics {
    double mean = 0.0, rms = 0.0, p95 = 0.0; // [m]
};
DistanceStatistics statistics(std::vector<double> distances);
double share_within(std::span<const double> distances, double limit);
double median(std::vector<double> values); // NaN for none

TriangleMesh moved(const TriangleMesh& mesh, const Rigid& motion);

// The rigid motion that brings the samples of a model onto a reference surface: point to plane, iterated, trimmed at
// `reach` [m] which halves as it converges (Chen and Medioni 1991). Identity when too few points are near.
Rigid register_surface(std::span<const SurfaceSample> model, const TriangleMesh& reference, double reach);

} // namespace quoin
