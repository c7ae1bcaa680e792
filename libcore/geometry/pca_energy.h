// The planarity energy of a cluster of triangles (Cai, Guo et al. 2017, "Surface approximation via PCA"):
//     E = det(M) / A^4,   M = integral (x-c)(x-c)^T dA.
// A rectangle of area A with normal noise of deviation s has E = A s^2 / 144, whatever its aspect ratio.
#pragma once

#include "geometry/moments.h"

#include <algorithm>
#include <cmath>

namespace quoin {

// Coefficients of the characteristic polynomial of the central moments M of a cluster of area A.
struct Invariants {
    double area = 0.0;   // A [m^2]
    double trace = 0.0;  // l1 + l2 + l3 [m^4]
    double minors = 0.0; // l1 l2 + l2 l3 + l3 l1 [m^8]
    double det = 0.0;    // l1 l2 l3 [m^12]

    // Is the variance across the least-squares plane, l3 / A [m^2], certainly at most or certainly above a value?
    // det/minors <= l3 <= 3 det/minors.
    bool variance_is_below(double variance) const { return 3.0 * det <= variance * area * minors || minors <= 0.0; }
    bool variance_is_above(double variance) const { return det > variance * area * minors && minors > 0.0; }
};

inline Invariants invariants(const Moments& m)
{
    if (m.area <= 0.0) return {};
    const double x = m.first.x(), y = m.first.y(), z = m.first.z(), r = 1.0 / m.area;
    const double xx = m.second[0] - x * x * r, xy = m.second[1] - x * y * r, xz = m.second[2] - x * z * r;
    const double yy = m.second[3] - y * y * r, yz = m.second[4] - y * z * r, zz = m.second[5] - z * z * r;
    const double cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - xz * yy;
    return {m.area, xx + yy + zz, cxx + (xx * zz - xz * xz) + (xx * yy - xy * xy), xx * cxx + xy * cxy + xz * cxz};
}

// E(C) [m^4]. Below `flat_variance` [m^2], where det(M) is rounding noise, a cluster counts as flat, and E is a
// vanishing multiple of trace(M) A, so that among flat clusters the compact ones come first.
inline double pca_energy(const Invariants& i, double flat_variance)
{
    constexpr double kFlatScale = 1e-20; // far below the energy of any cluster that is not flat
    if (i.area <= 0.0) return 0.0;
    if (!i.variance_is_above(flat_variance)) return std::max(0.0, i.trace) * i.area * kFlatScale;
    const double area2 = i.area * i.area;
    return i.det / (area2 * area2);
}

inline double pca_energy(const Moments& moments, double flat_variance)
{
    return pca_energy(invariants(moments), flat_variance);
}

} // namespace quoin
