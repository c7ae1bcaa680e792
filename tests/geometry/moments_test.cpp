#include "geometry/moments.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <random>

namespace quoin {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

Matrix3d full(const Eigen::Matrix<double, 6, 1>& s)
{
    Matrix3d m;
    m << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
    return m;
}

// Moments by splitting a triangle until each piece is as good as a point at its centroid.
Moments summed(const Vector3d& a, const Vector3d& b, const Vector3d& c, int depth)
{
    if (depth > 0) {
        const Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
        return summed(a, ab, ca, depth - 1) + summed(ab, b, bc, depth - 1) + summed(ca, bc, c, depth - 1) +
               summed(ab, bc, ca, depth - 1);
    }
    Moments point;
    const Vector3d g = (a + b + c) / 3;
    point.area = 0.5 * (b - a).cross(c - a).norm();
    point.first = point.area * g;
    const Matrix3d S = point.area * g * g.transpose();
    point.second << S(0, 0), S(0, 1), S(0, 2), S(1, 1), S(1, 2), S(2, 2);
    return point;
}

// A rectangle of w x h metres in the plane z = 0, its corner at `corner`.
Moments rectangle(double w, double h, const Vector3d& corner = Vector3d::Zero())
{
    const Vector3d x(w, 0, 0), y(0, h, 0);
    return triangle_moments(corner, corner + x, corner + x + y) + triangle_moments(corner, corner + x + y, corner + y);
}

TEST(TriangleMoments, EqualTheSumOverAFineSubdivision)
{
    const Vector3d a(0.1, 0.2, 0.3), b(1.0, -0.5, 0.4), c(-0.2, 0.9, 1.5);
    const Moments exact = triangle_moments(a, b, c), sum = summed(a, b, c, 7);
    EXPECT_NEAR(exact.area, sum.area, 1e-12);
    EXPECT_LT((exact.first - sum.first).norm(), 1e-12);
    EXPECT_LT((exact.second - sum.second).norm(), 1e-4);
}

TEST(Moments, CentralIsTheTextbookFormForARectangle)
{
    const Matrix3d M = rectangle(3.0, 2.0, {5, 7, 0}).central();
    EXPECT_NEAR(M(0, 0), 3.0 * 3.0 * 3.0 * 2.0 / 12.0, 1e-9);
    EXPECT_NEAR(M(1, 1), 2.0 * 2.0 * 2.0 * 3.0 / 12.0, 1e-9);
    EXPECT_NEAR(M(2, 2), 0.0, 1e-12);
}

TEST(Moments, MergingAddsTheSpreadOfTheCentroids)
{
    const Moments left = rectangle(1, 1), right = rectangle(2, 1, {4, 1, 0});
    const Moments both = left + right;
    const Vector3d c = both.centroid();
    const auto shifted = [&](const Moments& part) {
        const Vector3d d = part.centroid() - c;
        return Matrix3d(part.central() + part.area * d * d.transpose());
    };
    EXPECT_LT((both.central() - shifted(left) - shifted(right)).norm(), 1e-10);
}

TEST(Moments, SubtractingUndoesAdding)
{
    const Moments left = rectangle(1, 2), right = rectangle(2, 1, {4, 1, 0});
    const Moments back = (left + right) - right;
    EXPECT_NEAR(back.area, left.area, 1e-14);
    EXPECT_LT((back.first - left.first).norm(), 1e-13);
    EXPECT_LT((back.second - left.second).norm(), 1e-12);
}

TEST(Moments, TranslatedAreThoseOfTheMovedTriangle)
{
    const Vector3d a(0, 0, 0), b(1, 0, 1), c(0, 2, 0), t(3, -1, 2);
    const Moments moved = triangle_moments(a, b, c).translated(t), direct = triangle_moments(a + t, b + t, c + t);
    EXPECT_LT((moved.first - direct.first).norm(), 1e-12);
    EXPECT_LT((moved.second - direct.second).norm(), 1e-12);
}

TEST(FitPlane, FindsATiltedPlaneThroughItsCentroid)
{
    const Vector3d normal = Vector3d(1, 2, 3).normalized(), u = normal.unitOrthogonal(), v = normal.cross(u),
                   o(0.5, 1, -2);
    const Plane plane = fit_plane(triangle_moments(o, o + u, o + v) + triangle_moments(o + u, o + u + v, o + v));
    EXPECT_NEAR(std::abs(plane.normal.dot(normal)), 1.0, 1e-12);
    EXPECT_NEAR(plane.signed_distance(o), 0.0, 1e-12);
}

TEST(FitPlane, OfNothingIsAUnitNormal) { EXPECT_NEAR(fit_plane(Moments{}).normal.norm(), 1.0, 1e-15); }

// Two unit squares d apart, parallel: RMS distance to the plane between is d/2; to one of them d/sqrt(2).
TEST(Rms, OfTwoParallelSquaresIsHalfTheirDistance)
{
    const double d = 0.02;
    const Moments both = rectangle(1, 1) + rectangle(1, 1, {0, 0, d});
    EXPECT_NEAR(rms_to_fit(both), d / 2, 1e-9);
    EXPECT_NEAR(rms_to_plane(both, Plane{Vector3d::UnitZ(), 0.0}), d / std::sqrt(2.0), 1e-12);
    EXPECT_EQ(rms_to_fit(Moments{}), 0.0);
}

// With M = A diag(s1^2, s2^2, s3^2), E = det(M) / A^4 = s1^2 s2^2 s3^2 / A; a rectangle has s1^2 s2^2 = A^2 / 144.
TEST(PcaEnergy, OfANoisyRectangleIsAreaTimesVarianceOver144)
{
    const double d = 0.02, w = 4.0, h = 1.0;
    const Moments layer = rectangle(w, h) + rectangle(w, h, {0, 0, d});
    const double A = layer.area, energy = layer.central().determinant() / std::pow(A, 4.0);
    const double s2 = d * d / 4.0, one_layer = w * h;
    EXPECT_NEAR(energy / (one_layer * one_layer / 144.0 * s2 / A), 1.0, 1e-9);
}

TEST(SmallestEigenvalue, AgreesWithAnIterativeSolver)
{
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        const Matrix3d B = Matrix3d::NullaryExpr([&] { return normal(random); });
        const Matrix3d M = B * B.transpose();
        const double expected = Eigen::SelfAdjointEigenSolver<Matrix3d>(M).eigenvalues()[0];
        EXPECT_NEAR(smallest_eigenvalue(M), expected, 1e-7 * M.trace());
    }
    EXPECT_NEAR(smallest_eigenvalue(2.5 * Matrix3d::Identity()), 2.5, 1e-15);
    EXPECT_NEAR(smallest_eigenvalue(full((Eigen::Matrix<double, 6, 1>() << 3, 0, 0, 2, 0, 1).finished())), 1.0, 1e-14);
}

} // namespace
} // namespace quoin
