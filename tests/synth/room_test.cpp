#include "synth/creases.h"
#include "synth/furnish.h"
#include "synth/polygon.h"
#include "synth/random.h"
#include "synth/room.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector3d;

Polygon rectangle(double x0, double y0, double x1, double y1)
{
    return {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
}

double area_of(const std::vector<Polygon>& pieces)
{
    double area = 0.0;
    for (const Polygon& piece : pieces)
        area += polygon_area(piece);
    return area;
}

double area_of(const Room& room)
{
    double area = 0.0;
    for (const PlanarSurface& surface : room.planar)
        area += area_of(surface.pieces);
    return area;
}

// A floor of 4 x 4 m and nothing else.
RoomBuilder bare_floor()
{
    RoomBuilder builder({4, 4, 3});
    builder.begin_object("floor", Rigid::Identity());
    builder.add_face(rectangle(-2, -2, 2, 2), {}, Vector3d::UnitX());
    return builder;
}

TEST(CutPolygon, SplitsAreaIntoCommonAndRest)
{
    CounterRandom random(7, RandomPurpose::Layout);
    for (int i = 0; i < 50; ++i) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        const Polygon hole = rectangle(x, y, x + random.uniform(0.1, 2), y + random.uniform(0.1, 2));
        const PolygonCut cut = cut_polygon(rectangle(-1, -1, 1, 1), hole, Vector3d::UnitZ());
        EXPECT_NEAR((cut.common.empty() ? 0.0 : polygon_area(cut.common)) + area_of(cut.rest), 4.0, 1e-9);
    }
}

TEST(CutPolygon, LeavesAPolygonWholeThatTheHoleOnlyTouches)
{
    const PolygonCut cut = cut_polygon(rectangle(0, 0, 1, 1), rectangle(1, 0, 2, 1), Vector3d::UnitZ());
    EXPECT_TRUE(cut.common.empty());
    ASSERT_EQ(cut.rest.size(), 1u);
    EXPECT_EQ(cut.rest[0].size(), 4u);
}

TEST(RoomBuilder, HidesTheFloorUnderABoxAndTheBottomOfTheBox)
{
    RoomBuilder builder = bare_floor();
    builder.begin_object("box", Rigid(Eigen::AngleAxisd(0.4, Vector3d::UnitZ())));
    builder.add_box({{0, 0, 0}, {1, 1, 1}}, {});
    const Room room = builder.take();
    EXPECT_EQ(room.planar.size(), 6u); // the floor and five sides
    EXPECT_NEAR(area_of(room), 16.0 - 1.0 + 5.0, 1e-9);
}

TEST(RoomBuilder, JoinsTheSidesOfTwoStepsIntoOnePlane)
{
    RoomBuilder builder = bare_floor();
    builder.begin_object("stairs", Rigid::Identity());
    builder.add_box({{0, 0, 0}, {0.3, 1, 0.2}}, {});
    builder.add_box({{0.3, 0, 0}, {0.6, 1, 0.4}}, {});
    const Room room = builder.take();
    EXPECT_EQ(room.planar.size(), 1u + 2u + 2u + 3u); // floor, two sides, two treads, two risers and the back
}

TEST(RoomBuilder, ShowsEveryFaceUprightToWhoStandsBeforeIt)
{
    for (const PlanarSurface& surface : furnish_room({}).planar) {
        EXPECT_NEAR((surface.right.cross(surface.down) + surface.plane.normal).norm(), 0.0, 1e-9) << surface.name;
        if (std::abs(surface.plane.normal.z()) < 0.5) {
            EXPECT_NEAR(surface.down.z(), -1.0, 1e-9) << surface.name;
        }
    }
}

TEST(FindCreases, FindsTwelveEdgesOfABoxOnTheFloor)
{
    RoomBuilder builder = bare_floor();
    builder.begin_object("box", Rigid::Identity());
    builder.add_box({{0, 0, 0}, {1, 1, 1}}, {});
    const Room room = builder.take();
    const std::vector<RoomCrease> creases = find_creases(room);
    EXPECT_EQ(creases.size(), 12u);
    const auto concave = std::count_if(creases.begin(), creases.end(), [&](const RoomCrease& c) {
        return c.inward[0].dot(room.planar[c.planes[1]].plane.normal) > 0.5;
    });
    EXPECT_EQ(concave, 4); // where it stands on the floor
    for (const RoomCrease& c : creases)
        EXPECT_NEAR((c.ends[1] - c.ends[0]).norm(), 1.0, 1e-9);
}

TEST(FindCreases, LieOnBothPlanesInAFurnishedRoom)
{
    const Room room = furnish_room({});
    const std::vector<RoomCrease> creases = find_creases(room);
    EXPECT_GT(creases.size(), 300u);
    for (const RoomCrease& c : creases)
        for (const PlaneId plane : c.planes)
            for (const Vector3d& end : c.ends)
                EXPECT_NEAR(room.planar[plane].plane.signed_distance(end), 0.0, 1e-6);
}

TEST(FurnishRoom, ClosesTheSurfaceAroundTheRoom)
{
    // By the divergence theorem the area vectors of a closed surface add up to zero; piece by piece, whatever is cut.
    for (std::int64_t seed = 1; seed <= 4; ++seed) {
        SynthParams params;
        params.seed = seed;
        Room room = furnish_room(params);
        Vector3d sum = Vector3d::Zero();
        for (const PlanarSurface& s : room.planar)
            sum += area_of(s.pieces) * s.plane.normal;
        for (const LatheSurface& lathe : room.curved)
            if (const double r = lathe.profile.back().x(); r > 0.0) // stands on a polygon, which it hides
                sum.z() += 0.5 * lathe.segments * r * r * std::sin(2.0 * std::numbers::pi / lathe.segments);
        EXPECT_LT(sum.norm(), 1e-6) << "seed " << seed;
    }
}

} // namespace
} // namespace quoin
