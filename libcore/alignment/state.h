// The unknowns of the alignment and how a small step moves each of them.
#pragma once

#include "base/lanes.h"
#include "geometry/camera.h"
#include "geometry/plane.h"
#include "geometry/rigid.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

using Vector3 = Eigen::Vector3d;
using TangentBasis = Eigen::Matrix<double, 3, 2>;
using CalibrationStep =
    Eigen::Matrix<double, 9, 1>; // turn [rad] and shift [m] of color_from_depth, log focal, cx, cy [px]

// normal . (x - center) + offset = 0. About a centre near its points, normal and offset are hardly correlated.
struct CenteredPlane {
    Vector3 normal = Vector3::UnitZ();
    double offset = 0.0;              // [m]
    Vector3 center = Vector3::Zero(); // [m], fixed

    double signed_distance(const Vector3& p) const { return normal.dot(p - center) + offset; }
    Vector3 project(const Vector3& p) const { return p - signed_distance(p) * normal; }
    Eigen::Affine3d projection() const; // the same as a map
    // Two axes orthogonal to the normal; a function of the normal alone.
    TangentBasis tangents() const;
    // The plane after a step (alpha, s): normal + tangents alpha, normalised; offset + s.
    CenteredPlane moved(const Vector3& step) const;
    Plane plane() const { return {normal, offset - normal.dot(center)}; }
};
CenteredPlane centered(const Plane& plane, const Vector3& center);

// Corrected grey = gain * observed + bias, grey 0..1.
struct Exposure {
    double gain = 1.0;
    double bias = 0.0;
};

// The colour camera, shared by all frames.
struct ColorCamera {
    Camera camera; // at full size
    Rigid color_from_depth = Rigid::Identity();

    ColorCamera moved(const CalibrationStep& step) const;
};

inline Twist twist(const Vector3& omega, const Vector3& v)
{
    Twist result;
    result.head<3>() = omega;
    result.tail<3>() = v;
    return result;
}

struct AlignmentState {
    std::vector<Rigid> camera_from_world; // K, depth cameras; a step xi = (omega, v) maps T to exp(xi) T
    std::vector<CenteredPlane> plane;     // P
    std::vector<Exposure> exposure;       // K
    ColorCamera color;
};

inline Rigid moved(const Rigid& camera_from_world, const Twist& step)
{
    return orthonormalized(exp_twist(step) * camera_from_world);
}

// Cost r^2 that turns linear at `delta`, and its weight for Gauss-Newton.
inline double huber_cost(double r, double delta)
{
    const double size = std::abs(r);
    return size <= delta ? r * r : delta * (2.0 * size - delta);
}
inline Floats huber_cost(const Floats& r, float delta)
{
    const Floats size = size_of(r);
    return size <= delta ? r * r : delta * (2.0f * size - delta);
}
inline double huber_weight(double r, double delta)
{
    const double size = std::abs(r);
    return size <= delta ? 1.0 : delta / size;
}

} // namespace quoin
