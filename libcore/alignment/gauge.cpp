#include "alignment/gauge.h"

#include <Eigen/Cholesky>

namespace quoin {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kSteps = 4;         // Gauss-Newton; motions are small
constexpr double kDamping = 1e-9; // relative; holds what no plane constrains, such as a slide along parallel walls

// Normal equations of moving the points x of all clusters by (omega, v) onto the planes. A point's row is (x cross n,
// n); with x = c + y and the sum of y zero, the sum over the points needs their scatter S only. Rotations are about
// `origin`.
struct Normal {
    Matrix6 H = Matrix6::Zero();
    Twist g = Twist::Zero();
};

void add(Normal& normal, const PlaneScatter& scatter, const CenteredPlane& plane, const Vector3& origin)
{
    const Twist row = twist((scatter.center - origin).cross(plane.normal), plane.normal);
    const Eigen::Matrix3d turn = skew(plane.normal); // y cross n = -turn y
    normal.H += scatter.weight * row * row.transpose();
    normal.H.topLeftCorner<3, 3>() += turn * scatter.scatter * turn.transpose();
    normal.g += scatter.weight * plane.signed_distance(scatter.center) * row;
    normal.g.head<3>() -= turn * scatter.scatter * plane.normal;
}

Vector3 mean_center(const std::vector<PlaneScatter>& scatter)
{
    Vector3 sum = Vector3::Zero();
    double weight = 0.0;
    for (const PlaneScatter& s : scatter) {
        sum += s.weight * s.center;
        weight += s.weight;
    }
    return weight > 0.0 ? Vector3(sum / weight) : sum;
}

Rigid world_from_solution(const AlignmentState& state, const std::vector<PlaneScatter>& scatter)
{
    const Vector3 origin = mean_center(scatter);
    Normal normal;
    for (std::size_t p = 0; p < state.plane.size(); ++p)
        add(normal, scatter[p], state.plane[p], origin);
    const double scale = normal.H.trace();
    if (!(scale > 0.0)) return Rigid::Identity();
    normal.H += kDamping * scale * Matrix6::Identity();
    const Twist points_to_planes = -normal.H.ldlt().solve(normal.g);
    if (!points_to_planes.allFinite()) return Rigid::Identity();
    const Eigen::Translation3d to_origin(-origin);
    return (to_origin.inverse() * exp_twist(points_to_planes) * to_origin).inverse();
}

CenteredPlane moved(const CenteredPlane& plane, const Rigid& motion)
{
    const Vector3 on_plane = motion * plane.project(plane.center);
    CenteredPlane result = plane;
    result.normal = (motion.linear() * plane.normal).normalized();
    result.offset = -result.normal.dot(on_plane - plane.center);
    return result;
}

} // namespace

AlignmentState returned_to_mesh(AlignmentState state, const std::vector<PlaneScatter>& scatter)
{
    for (int step = 0; step < kSteps; ++step) {
        const Rigid motion = world_from_solution(state, scatter);
        for (CenteredPlane& plane : state.plane)
            plane = moved(plane, motion);
        for (Rigid& camera_from_world : state.camera_from_world)
            camera_from_world = orthonormalized(camera_from_world * motion.inverse());
    }
    return state;
}

} // namespace quoin
