// Area moments of a set of triangles: {A, m, S} with A = integral dA, m = integral x dA, S = integral x x^T dA. They
// add up under union and give plane, energy and RMS distance in closed form (Cai et al. 2017; algorithms of
// section 3.1). Keep them about an origin near the data: S - m m^T / A cancels far from it.
#pragma once

#include "geometry/plane.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace quoin {

struct Moments {
    double area = 0.0;                                                        // [m^2]
    Eigen::Vector3d first = Eigen::Vector3d::Zero();                          // [m^3]
    Eigen::Matrix<double, 6, 1> second = Eigen::Matrix<double, 6, 1>::Zero(); // xx xy xz yy yz zz [m^4]

    Moments& operator+=(const Moments& other)
    {
        area += other.area;
        first += other.first;
        second += other.second;
        return *this;
    }
    Moments& operator-=(const Moments& other)
    {
        area -= other.area;
        first -= other.first;
        second -= other.second;
        return *this;
    }
    friend Moments operator+(Moments a, const Moments& b) { return a += b; }
    friend Moments operator-(Moments a, const Moments& b) { return a -= b; }

    Eigen::Vector3d centroid() const { return area > 0.0 ? Eigen::Vector3d(first / area) : Eigen::Vector3d::Zero(); }
    // Integral of (x-c)(x-c)^T dA about the centroid c [m^4].
    Eigen::Matrix3d central() const;
    // The same set of triangles, moved by `shift`.
    Moments translated(const Eigen::Vector3d& shift) const;
};

// Exact moments of the triangle a b c. Inline, for it is called for every face.
inline Moments triangle_moments(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c)
{
    Moments moments;
    moments.area = 0.5 * (b - a).cross(c - a).norm();
    const Eigen::Vector3d s = a + b + c;
    moments.first = moments.area / 3.0 * s;
    const double w = moments.area / 12.0;
    const auto product = [&](int i, int j) { return w * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]); };
    moments.second << product(0, 0), product(0, 1), product(0, 2), product(1, 1), product(1, 2), product(2, 2);
    return moments;
}

// Least-squares plane (eigenvector of the smallest eigenvalue of the central moments, through the centroid). The sign
// of the normal is arbitrary. A set without area gives the plane z = 0 through its centroid.
Plane fit_plane(const Moments& moments);

// RMS distance of the set to its own least-squares plane, and to a given plane [m].
double rms_to_fit(const Moments& moments);
double rms_to_plane(const Moments& moments, const Plane& plane);

// Smallest eigenvalue of a symmetric 3x3 matrix, in closed form.
double smallest_eigenvalue(const Eigen::Matrix3d& matrix);

} // namespace quoin
