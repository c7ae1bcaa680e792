#include "mesh/creases.h"

#include "geometry/units.h"

#include <gtest/gtest.h>
#include <random>

namespace quoin {
namespace {

constexpr double kMinAngle = 10.0; // [deg]

Plane plane_through(const Eigen::Vector3d& point, const Eigen::Vector3d& direction)
{
    const Eigen::Vector3d normal = direction.normalized();
    return {normal, -normal.dot(point)};
}

PlaneMeeting meet(const Eigen::Vector3d& point, const std::vector<Plane>& planes)
{
    return meet_planes(point, planes, radians(kMinAngle));
}

TEST(MeetPlanes, OfNoneIsThePointItselfAndOfOneItsProjection)
{
    EXPECT_EQ(meet({1, 2, 3}, {}).rank, 0);
    const auto meeting = meet({1, 2, 3}, {plane_through({0, 0, 1}, {0, 0, 1})});
    EXPECT_EQ(meeting.rank, 1);
    EXPECT_TRUE(meeting.point.isApprox(Eigen::Vector3d(1, 2, 1)));
}

// Any two planes, normals to the same or to opposite sides: on both of them, and the offset is along their normals.
TEST(MeetPlanes, OfTwoIsTheNearestPointOfTheirLine)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto vector = [&]() -> Eigen::Vector3d {
        const double x = uniform(random), y = uniform(random);
        return {x, y, uniform(random)};
    };
    for (int i = 0; i < 200; ++i) {
        const Plane a = plane_through(vector(), vector()), b = plane_through(vector(), vector());
        const Eigen::Vector3d point = vector(), line = a.normal.cross(b.normal);
        const auto meeting = meet(point, {a, b});
        if (line.norm() < std::sin(radians(1.1 * kMinAngle))) continue;
        ASSERT_EQ(meeting.rank, 2) << i;
        EXPECT_NEAR(a.signed_distance(meeting.point), 0.0, 1e-9) << i;
        EXPECT_NEAR(b.signed_distance(meeting.point), 0.0, 1e-9) << i;
        EXPECT_NEAR((meeting.point - point).dot(line.normalized()), 0.0, 1e-9) << i;
        const auto thrice = meet(point, {a, b, b}); // the way of three planes and more
        EXPECT_EQ(thrice.rank, 2) << i;
        EXPECT_TRUE(meeting.point.isApprox(thrice.point, 1e-9)) << i;
    }
}

TEST(MeetPlanes, OfTwoNearlyParallelOnesIsOnThePlaneBetweenThem)
{
    const double half = radians(0.4 * kMinAngle);
    for (const double side : {1.0, -1.0}) {
        const Plane a = plane_through({0, 0, 0}, {std::sin(half), 0, std::cos(half)});
        const Plane b = plane_through({0, 0, 0.02}, side * Eigen::Vector3d(-std::sin(half), 0, std::cos(half)));
        const auto meeting = meet({0, 0, 0.5}, {a, b});
        EXPECT_EQ(meeting.rank, 1);
        EXPECT_NEAR(std::abs(a.signed_distance(meeting.point)), std::abs(b.signed_distance(meeting.point)), 1e-12);
        EXPECT_NEAR(meeting.point.z(), 0.01, 1e-3);
    }
}

TEST(MeetPlanes, OfThreeIsTheirCorner)
{
    const auto meeting =
        meet({0.3, 0.2, 0.1}, {plane_through({1, 0, 0}, {1, 0, 0}), plane_through({0, 2, 0}, {0, 1, 0}),
                               plane_through({0, 0, 3}, {0, 0, 1})});
    EXPECT_EQ(meeting.rank, 3);
    EXPECT_TRUE(meeting.point.isApprox(Eigen::Vector3d(1, 2, 3)));
}

} // namespace
} // namespace quoin
