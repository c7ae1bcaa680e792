#include "alignment/plane_term.h"

namespace quoin {
namespace {

PlaneScatter scatter_of(const Moments& moments, double points_per_weight)
{
    return {moments.centroid(), points_per_weight * moments.central(), points_per_weight * moments.area};
}

} // namespace

std::vector<PlaneScatter> scatters_of_moments(const PlaneMesh& mesh, double spacing)
{
    std::vector<PlaneScatter> scatters;
    for (const Moments& moments : mesh.moments)
        scatters.push_back(scatter_of(moments, 1.0 / (spacing * spacing)));
    return scatters;
}

std::vector<PlaneScatter> scatters_of_texels(const Texels& texels)
{
    std::vector<PlaneScatter> scatters;
    for (std::size_t p = 0; p + 1 < texels.first_of_plane.size(); ++p) {
        Moments points; // of points of unit weight
        for (TexelId t = texels.first_of_plane[p]; t < texels.first_of_plane[p + 1]; ++t) {
            const Vector3 x = texels.p_world[t].cast<double>();
            points.area += 1.0;
            points.first += x;
            const Eigen::Matrix3d square = x * x.transpose();
            points.second += (Eigen::Matrix<double, 6, 1>() << square(0, 0), square(0, 1), square(0, 2), square(1, 1),
                              square(1, 2), square(2, 2))
                                 .finished();
        }
        scatters.push_back(scatter_of(points, 1.0));
    }
    return scatters;
}

PlaneBlock plane_block(const PlaneScatter& scatter, const CenteredPlane& plane)
{
    const TangentBasis B = plane.tangents();
    const double offset = plane.signed_distance(scatter.center);
    Vector3 by_offset; // derivative of `offset` by (alpha, s)
    by_offset.head<2>() = B.transpose() * (scatter.center - plane.center);
    by_offset.z() = 1.0;
    PlaneBlock block;
    block.cost = plane.normal.dot(scatter.scatter * plane.normal) + scatter.weight * offset * offset;
    block.g = scatter.weight * offset * by_offset;
    block.g.head<2>() += B.transpose() * scatter.scatter * plane.normal;
    block.H = scatter.weight * by_offset * by_offset.transpose();
    block.H.topLeftCorner<2, 2>() += B.transpose() * scatter.scatter * B;
    return block;
}

} // namespace quoin
