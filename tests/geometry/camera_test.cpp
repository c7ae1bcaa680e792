#include "geometry/camera.h"
#include "geometry/plane.h"
#include "geometry/union_find.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

const Camera kCamera{640, 480, 525.0, 520.0, 319.5, 239.5};

TEST(Camera, RayTimesDepthProjectsBackToItsPixel)
{
    const Eigen::Vector2d pixel(12.25, 400.5);
    EXPECT_LT((kCamera.project(2.7 * kCamera.ray(pixel)) - pixel).norm(), 1e-12);
}

TEST(Camera, PixelCentresOfTheBorderAreInsideAndABorderShrinksTheImage)
{
    EXPECT_TRUE(kCamera.contains({0, 0}));
    EXPECT_TRUE(kCamera.contains({639, 479}));
    EXPECT_FALSE(kCamera.contains({639.01, 10}));
    EXPECT_FALSE(kCamera.contains({4.9, 10}, 5.0));
}

TEST(Camera, HalfSizePixelCoversTheMiddleOfItsFour)
{
    const Camera half = kCamera.at_level(1);
    EXPECT_EQ(half.width, 320);
    EXPECT_DOUBLE_EQ(half.cx, 159.5);
    const Eigen::Vector3d ray = kCamera.ray({100.5, 60.5}); // the middle of pixels 100, 101 and 60, 61
    EXPECT_LT((half.project(ray) - Eigen::Vector2d(50, 30)).norm(), 1e-12);
}

TEST(Plane, ProjectedPointLiesOnItAndFlippingTurnsTheSign)
{
    const Plane plane{Eigen::Vector3d(0, 0.6, 0.8), -2.0};
    const Eigen::Vector3d p(1, 2, 3);
    EXPECT_NEAR(plane.signed_distance(plane.project(p)), 0.0, 1e-15);
    EXPECT_DOUBLE_EQ(plane.flipped().signed_distance(p), -plane.signed_distance(p));
}

TEST(UnionFind, JoinedSetsHaveTheChosenRoot)
{
    UnionFind sets(5);
    sets.join(2, 4);
    sets.join(0, 2);
    EXPECT_EQ(sets.find(4), 0u);
    EXPECT_EQ(sets.find(3), 3u);
    EXPECT_TRUE(sets.is_root(0));
    EXPECT_FALSE(sets.is_root(2));
}

} // namespace
} // namespace quoin
