// The plane term E_p: planes stay with the surface they were fitted to. In closed form over the dense cluster (its area
// moments) or over sampled points (the paper); both are a sum of squared distances.
#pragma once

#include "alignment/samples.h"
#include "alignment/state.h"

namespace quoin {

// Sum over points x of (distance of x to a plane)^2 = n^T scatter n + weight (distance of the points' mean c)^2.
struct PlaneScatter {
    Vector3 center = Vector3::Zero();
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero(); // [m^2]
    double weight = 0.0;                               // number of points
};

// Of the dense clusters, as if they were sampled with one point every `spacing`^2.
std::vector<PlaneScatter> scatters_of_moments(const PlaneMesh& mesh, double spacing);
// Of the sampled texels.
std::vector<PlaneScatter> scatters_of_texels(const Texels& texels);

struct PlaneBlock {
    double cost = 0.0;                           // [m^2]
    Vector3 g = Vector3::Zero();                 // half the exact gradient by (alpha, s)
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero(); // Gauss-Newton, positive semi-definite
};
PlaneBlock plane_block(const PlaneScatter& scatter, const CenteredPlane& plane);

} // namespace quoin
