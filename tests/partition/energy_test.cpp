#include "geometry/pca_energy.h"
#include "support/grids.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

constexpr double kFlat = 1e-14; // [m^2]

Moments moments_of(const TriangleMesh& mesh)
{
    Moments sum;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        sum += triangle_moments(corner(mesh, f, 0), corner(mesh, f, 1), corner(mesh, f, 2));
    return sum;
}

Moments random_triangle(std::mt19937& random)
{
    std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
    const auto point = [&] { return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random)); };
    return triangle_moments(point(), point(), point());
}

// A flat rectangle thickened: every point moved by +-s with equal shares, so that the variance is exactly s^2.
Moments thick_rectangle(double width, double height, double s)
{
    Moments sum;
    for (const double z : {-s, s})
        for (const auto& [a, b, c] : {std::array<Eigen::Vector2d, 3>{{{0, 0}, {width, 0}, {width, height}}},
                                      std::array<Eigen::Vector2d, 3>{{{0, 0}, {width, height}, {0, height}}}}) {
            const auto at = [&](const Eigen::Vector2d& p) { return Eigen::Vector3d(p.x(), p.y(), z); };
            Moments half = triangle_moments(at(a), at(b), at(c));
            half.area *= 0.5;
            half.first *= 0.5;
            half.second *= 0.5;
            sum += half;
        }
    return sum;
}

TEST(PcaEnergy, OfARectangleIsAreaTimesVarianceOver144WhateverItsAspect)
{
    for (const double width : {0.1, 1.0, 7.0}) {
        const double area = width * 0.5, s = 0.004;
        EXPECT_NEAR(pca_energy(thick_rectangle(width, 0.5, s), kFlat), area * s * s / 144.0, 1e-9 * area * s * s);
    }
}

TEST(PcaEnergy, OfANoisyRectangleIsAreaTimesVarianceOver144)
{
    const TriangleMesh mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}, 120, 60, 0.0005);
    const Moments sum = moments_of(mesh);
    const double variance =
        rms_to_fit(sum) * rms_to_fit(sum); // of the surface; linear faces smooth the vertices' noise
    EXPECT_NEAR(pca_energy(sum, kFlat) / (sum.area * variance / 144.0), 1.0, 0.02);
}

TEST(PcaEnergy, OfFlatClustersIsTinyAndLessForCompactOnes)
{
    const double square = pca_energy(thick_rectangle(1.0, 1.0, 0.0), kFlat),
                 strip = pca_energy(thick_rectangle(4.0, 0.25, 0.0), kFlat);
    EXPECT_GT(square, 0.0);
    EXPECT_LT(square, strip);
    EXPECT_LT(strip, pca_energy(thick_rectangle(1.0, 1.0, 1e-5), kFlat));
    EXPECT_EQ(pca_energy(Moments{}, kFlat), 0.0);
}

TEST(PcaEnergy, VarianceLiesBetweenItsBounds)
{
    std::mt19937 random(3);
    for (int i = 0; i < 100; ++i) {
        Moments sum;
        for (int k = 0; k < 4; ++k)
            sum += random_triangle(random);
        const Invariants bounds = invariants(sum);
        const double variance = rms_to_fit(sum) * rms_to_fit(sum);
        EXPECT_FALSE(bounds.variance_is_above(variance * (1 + 1e-9)));
        EXPECT_FALSE(bounds.variance_is_below(variance * (1 - 1e-9)));
    }
}

TEST(Moments, SumsAfterRandomJoinsAndRemovalsEqualDirectSums)
{
    std::mt19937 random(5);
    std::vector<Moments> triangles;
    for (int i = 0; i < 200; ++i)
        triangles.push_back(random_triangle(random));
    std::vector<int> inside(triangles.size(), 0);
    Moments sum;
    for (int step = 0; step < 20000; ++step) {
        const std::size_t i = random() % triangles.size();
        if (inside[i])
            sum -= triangles[i];
        else
            sum += triangles[i];
        inside[i] ^= 1;
    }
    Moments direct;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        if (inside[i]) direct += triangles[i];
    EXPECT_NEAR(sum.area, direct.area, 1e-10 * direct.area);
    EXPECT_LT((sum.first - direct.first).norm(), 1e-10 * direct.area);
    EXPECT_LT((sum.second - direct.second).norm(), 1e-10 * direct.second.norm());
    EXPECT_NEAR(pca_energy(sum, kFlat), pca_energy(direct, kFlat), 1e-8 * pca_energy(direct, kFlat));
}

} // namespace
} // namespace quoin
