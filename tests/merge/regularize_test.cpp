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

// A wall, a picture 3 cm before it, and the side of the picture, which fusion has laid aslant.
constexpr PlaneId kWall = 0, kFront = 1, kSide = 2;
const std::vector<std::pair<PlaneId, PlaneId>> kStep{{kWall, kSide}, {kFront, kSide}};
Planes picture()
{
    Planes planes;
    planes.add({-1.5, -1.5, 0.0}, {3.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
    planes.add({-0.4, 0.0, 0.03}, {0.4, 0.0, 0.0}, {0.0, 0.6, 0.0});
    planes.add({0.0, 0.0, 0.03}, {0.02, 0.0, -0.03}, {0.0, 0.6, 0.0});
    return planes;
}

TEST(Regularize, StandsTheSideOfAPictureUpOnTheWall)
{
    const Planes planes = picture();
    const auto result = planes.regularized(kStep);
    EXPECT_NEAR(degrees_between(planes.plane[kWall], planes.plane[kSide]), 56.3, 0.1);
    EXPECT_NEAR(degrees_between(result[kWall], result[kSide]), 90.0, 1.0);
    EXPECT_EQ(result[kWall].normal, planes.plane[kWall].normal);
    EXPECT_EQ(result[kFront].normal, planes.plane[kFront].normal);
}

TEST(Regularize, TurnsPlanesAboutTheirCentroids)
{
    const Planes planes = picture();
    const auto result = planes.regularized(kStep);
    for (std::size_t p = 0; p < result.size(); ++p) {
        EXPECT_NEAR(result[p].normal.norm(), 1.0, 1e-12);
        EXPECT_NEAR(result[p].signed_distance(planes.moments[p].centroid()), 0.0, 1e-9);
        EXPECT_GT(result[p].normal.dot(planes.plane[p].normal), 0.0);
    }
}

TEST(Regularize, TurnsAcrossStripsOnly)
{
    Planes planes = picture();
    const Vector3d along = Vector3d(0.0, 1.0, 0.2).normalized(); // it climbs, and its length tells that well
    const PlaneId climbing = planes.add({0.0, 0.0, 0.03}, {0.02, 0.0, -0.03}, 0.6 * along);
    const auto result = planes.regularized({{kWall, climbing}, {kFront, climbing}});
    EXPECT_NE(result[climbing].normal, planes.plane[climbing].normal);
    EXPECT_NEAR(result[climbing].normal.dot(along), 0.0, 0.02);
}

TEST(Regularize, TurnsOnlyStepsFarFromTheirFaces)
{
    const Planes planes = picture();
    EXPECT_EQ(planes.regularized({{kWall, kSide}})[kSide].normal, planes.plane[kSide].normal)
        << "a bevel, for all that is known";
}

TEST(Regularize, LeavesARampWhoseSlopeIsKnown)
{
    Planes planes = picture();
    const PlaneId ramp = planes.add({0.0, 0.0, 0.0}, {1.0, 0.0, 0.5}, {0.0, 1.0, 0.0});
    const auto result = planes.regularized({{kWall, ramp}});
    EXPECT_EQ(result[ramp].normal, planes.plane[ramp].normal);
    EXPECT_EQ(result[ramp].offset, planes.plane[ramp].offset);
}

TEST(Regularize, LeavesAnAskewWall)
{
    Planes planes = picture();
    const double lean = radians(0.5);
    const PlaneId askew =
        planes.add({-1.5, -1.5, 0.0}, {3.0, 0.0, 0.0}, 2.5 * Vector3d(0.0, std::sin(lean), std::cos(lean)));
    EXPECT_EQ(planes.regularized({{kWall, askew}})[askew].normal, planes.plane[askew].normal);
}

TEST(Regularize, MakesStripsParallelToFarWalls)
{
    Planes planes = picture();
    const double lean = radians(6.0);
    const PlaneId shelf =
        planes.add({1.0, 1.0, 0.3}, {0.6, 0.0, 0.0}, 0.05 * Vector3d(0.0, std::cos(lean), std::sin(lean)));
    EXPECT_LT(degrees_between(planes.regularized({})[shelf], planes.plane[kWall]), 1.0);
}

TEST(Regularize, SmallPlanesDirectOnlyTheirNeighbours)
{
    Planes planes;
    const double lean = radians(84.0);
    planes.add({0.0, 0.0, 0.0}, {0.3, 0.0, 0.0}, {0.0, 0.3, 0.0});
    planes.add({0.0, 0.0, 0.0}, {0.0, 0.3, 0.0}, 0.03 * Vector3d(std::cos(lean), 0.0, std::sin(lean)));
    EXPECT_EQ(planes.regularized({})[1].normal, planes.plane[1].normal);
    EXPECT_NEAR(degrees_between(planes.regularized({{0, 1}})[1], planes.plane[0]), 90.0, 1.0);
}

TEST(Regularize, PlanesWithoutAreaStayFinite)
{
    Planes planes = picture();
    const PlaneId none = planes.add({0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
    planes.plane[none] = {};
    for (const Plane& plane : planes.regularized({{kWall, none}, {kSide, none}})) {
        EXPECT_TRUE(plane.normal.allFinite());
        EXPECT_TRUE(std::isfinite(plane.offset));
    }
}

} // namespace
} // namespace quoin
