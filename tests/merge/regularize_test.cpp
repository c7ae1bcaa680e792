#include "merge/regularize.h"

#include "geometry/units.h"

#include <gtest/gtest.h>

#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector3d;

struct Planes {
    std::vector<Plane> plane;
    std::vector<Moments> moments;

    // A parallelogram with the normal along x cross y.
    PlaneId add(const Vector3d& corner, const Vector3d& x, const Vector3d& y)
    {
        moments.push_back(triangle_moments(corner, corner + x, corner + x + y) +
                          triangle_moments(corner, corner + x + y, corner + y));
        const Vector3d n = x.cross(y).normalized();
        plane.push_back({n, -n.dot(corner)});
        return static_cast<PlaneId>(plane.size() - 1);
    }
    std::vector<Plane> regularized(const std::vector<std::pair<PlaneId, PlaneId>>& neighbours) const
    {
        return regularize(plane, moments, neighbours, MergeParams{});
    }
};

double degrees_between(const Plane& a, const Plane& b)
{
    return std::acos(std::clamp(a.normal.dot(b.normal), -1.0, 1.0)) * kDegrees;
}

// A wall, and the side of a picture 3 cm thick that fusion has laid aslant.
Planes wall_and_strip()
{
    Planes planes;
    planes.add({-1.5, -1.5, 0.0}, {3.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
    planes.add({0.0, 0.0, 0.03}, {0.02, 0.0, -0.03}, {0.0, 0.6, 0.0});
    return planes;
}

TEST(Regularize, StandsANarrowStripUpOnTheWall)
{
    const Planes planes = wall_and_strip();
    const auto result = planes.regularized({{0, 1}});
    EXPECT_NEAR(degrees_between(planes.plane[0], planes.plane[1]), 56.3, 0.1);
    EXPECT_NEAR(degrees_between(result[0], result[1]), 90.0, 1.0);
    EXPECT_LT(degrees_between(result[0], planes.plane[0]), 1e-3) << "the strip must not turn the wall";
}

TEST(Regularize, TurnsPlanesAboutTheirCentroids)
{
    const Planes planes = wall_and_strip();
    const auto result = planes.regularized({{0, 1}});
    for (std::size_t p = 0; p < result.size(); ++p) {
        EXPECT_NEAR(result[p].normal.norm(), 1.0, 1e-12);
        EXPECT_NEAR(result[p].signed_distance(planes.moments[p].centroid()), 0.0, 1e-9);
        EXPECT_GT(result[p].normal.dot(planes.plane[p].normal), 0.0);
    }
}

TEST(Regularize, TurnsAlongTheNarrowSideOnly)
{
    Planes planes = wall_and_strip();
    const Vector3d along(0.0, 1.0, 0.2); // a strip that climbs: its length tells that well
    planes.add({1.0, 0.0, 0.1}, {0.02, 0.0, -0.03}, 0.6 * along.normalized());
    const auto result = planes.regularized({{0, 2}});
    EXPECT_NEAR(result[2].normal.dot(along.normalized()), 0.0, 0.01);
}

TEST(Regularize, LeavesARampWhoseSlopeIsKnown)
{
    Planes planes = wall_and_strip();
    planes.add({0.0, 0.0, 0.0}, {1.0, 0.0, 0.5}, {0.0, 1.0, 0.0});
    const auto result = planes.regularized({{0, 2}});
    EXPECT_EQ(result[2].normal, planes.plane[2].normal);
    EXPECT_EQ(result[2].offset, planes.plane[2].offset);
}

TEST(Regularize, MovesAnAskewWallByLittle)
{
    Planes planes = wall_and_strip();
    const double lean = radians(0.5);
    planes.add({-1.5, -1.5, 0.0}, {3.0, 0.0, 0.0}, 2.5 * Vector3d(0.0, std::sin(lean), std::cos(lean)));
    const auto result = planes.regularized({{0, 2}});
    EXPECT_LT(degrees_between(result[2], planes.plane[2]), 0.25 * 0.5) << "the prior is weak";
    EXPECT_GT(degrees_between(result[2], planes.plane[2]), 0.0);
}

TEST(Regularize, MakesPlanesParallelToFarWalls)
{
    Planes planes = wall_and_strip();
    const double lean = radians(3.0);
    planes.add({1.0, 1.0, 0.3}, {0.2, 0.0, 0.0}, 0.2 * Vector3d(0.0, std::cos(lean), std::sin(lean)));
    const auto result = planes.regularized({});
    EXPECT_LT(degrees_between(result[2], planes.plane[0]), 0.5);
}

TEST(Regularize, SmallPlanesDirectOnlyTheirNeighbours)
{
    Planes planes;
    planes.add({0.0, 0.0, 0.0}, {0.3, 0.0, 0.0}, {0.0, 0.3, 0.0});
    planes.add({0.0, 0.0, 0.03}, {0.02, 0.0, -0.03}, {0.0, 0.3, 0.0});
    EXPECT_EQ(planes.regularized({})[1].normal, planes.plane[1].normal);
    EXPECT_NEAR(degrees_between(planes.regularized({{0, 1}})[1], planes.plane[0]), 90.0, 2.0);
}

TEST(Regularize, PlanesWithoutAreaStayFinite)
{
    Planes planes = wall_and_strip();
    planes.add({0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
    planes.plane[2] = {};
    for (const Plane& plane : planes.regularized({{0, 2}, {1, 2}})) {
        EXPECT_TRUE(plane.normal.allFinite());
        EXPECT_TRUE(std::isfinite(plane.offset));
    }
}

} // namespace
} // namespace quoin
