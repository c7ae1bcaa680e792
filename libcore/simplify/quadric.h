// Quadric error (Garland 1999): Q(x) = x^T A x + 2 b.x + c, a weighted sum of squared distances to planes, lines and
// points.
#pragma once

#include "geometry/plane.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace quoin {

struct Quadric {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double c = 0.0;

    Quadric& operator+=(const Quadric& other)
    {
        A += other.A;
        b += other.b;
        c += other.c;
        return *this;
    }
    friend Quadric operator+(Quadric a, const Quadric& other) { return a += other; }

    double operator()(const Eigen::Vector3d& x) const { return x.dot(A * x) + 2.0 * b.dot(x) + c; }
    // Where Q is smallest, or `fallback` where that is not one point.
    Eigen::Vector3d minimizer(const Eigen::Vector3d& fallback) const
    {
        const Eigen::LLT<Eigen::Matrix3d> factor(A);
        if (factor.info() != Eigen::Success) return fallback;
        const Eigen::Vector3d x = factor.solve(-b);
        return x.allFinite() ? x : fallback;
    }

    // weight times the squared distance to {x : D (x - p) = 0} for a projector D.
    static Quadric of(const Eigen::Matrix3d& projector, const Eigen::Vector3d& p, double weight)
    {
        const Eigen::Vector3d Dp = projector * p;
        return {weight * projector, -weight * Dp, weight * p.dot(Dp)};
    }
    static Quadric of_plane(const Plane& plane, double weight)
    {
        return {weight * plane.normal * plane.normal.transpose(), weight * plane.offset * plane.normal,
                weight * plane.offset * plane.offset};
    }
    static Quadric of_line(const Eigen::Vector3d& p, const Eigen::Vector3d& direction, double weight)
    {
        return of(Eigen::Matrix3d::Identity() - direction * direction.transpose(), p, weight);
    }
    static Quadric of_point(const Eigen::Vector3d& p, double weight)
    {
        return of(Eigen::Matrix3d::Identity(), p, weight);
    }
};

} // namespace quoin
