#include "lines/follow_stretches.h"

#include "image/sampling.h"
#include "synth/camera_path.h"
#include "synth/furnish.h"
#include "synth/render_view.h"
#include "synth/truth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace quoin {
namespace {

constexpr double kRadian = 180.0 / std::numbers::pi; // [deg]

// 0..1; each pixel is the mean of `shade` over its square.
GrayImage drawn(const std::function<double(const Eigen::Vector2d&)>& shade)
{
    constexpr int kRays = 8;
    GrayImage image(200, 160);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            double sum = 0.0;
            for (int v = 0; v < kRays; ++v)
                for (int u = 0; u < kRays; ++u)
                    sum += shade(Eigen::Vector2d(x + (u + 0.5) / kRays - 0.5, y + (v + 0.5) / kRays - 0.5));
            image.at(x, y) = static_cast<float>(sum / (kRays * kRays));
        }
    return image;
}

GrayImage with_noise(GrayImage image, double grey_levels)
{
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0.0, grey_levels / 255.0);
    for (float& value : image.pixels)
        value = std::clamp(value + static_cast<float>(normal(random)), 0.0f, 1.0f);
    return image;
}

// A crease of a scene at 2 m that appears between two pixels of a 200 x 160 image.
struct Crease {
    Eigen::Vector2d from{40.3, 60.2}, to{155.1, 95.7};
    Eigen::Vector2d along() const { return (to - from).normalized(); }
    Eigen::Vector2d across() const { return {-along().y(), along().x()}; }
    double beside(const Eigen::Vector2d& u) const { return across().dot(u - from); }
};

MeshView view()
{
    MeshView view;
    view.camera = {.width = 200, .height = 160, .fx = 180, .fy = 180, .cx = 99.5, .cy = 79.5};
    view.camera_from_world = Rigid::Identity();
    return view;
}

Stretch stretch_of(const Crease& crease)
{
    constexpr double kDepth = 2.0; // [m]
    const Camera camera = view().camera;
    return {0, {camera.ray(crease.from) * kDepth, camera.ray(crease.to) * kDepth}, {crease.from, crease.to}};
}

DetectLinesParams guided()
{
    DetectLinesParams params;
    params.method = SegmentMethod::Guided;
    return params;
}

std::vector<SegmentMatch> follow(const GrayImage& image, const std::vector<Crease>& creases = {Crease{}},
                                 const DetectLinesParams& params = guided())
{
    std::vector<Stretch> stretches;
    for (const Crease& crease : creases)
        stretches.push_back(stretch_of(crease));
    return follow_stretches(image, stretches, view(), params);
}

// The true edge is the crease, turned about its middle and moved across.
struct TrueEdge {
    double offset = 0.0, turn = 0.0; // [px], [rad]
    Eigen::Vector2d middle, across;

    TrueEdge(double offset_px, double turn_deg) : offset(offset_px), turn(turn_deg / kRadian)
    {
        const Crease crease;
        across = Eigen::Rotation2Dd(turn) * crease.across();
        middle = 0.5 * (crease.from + crease.to) + offset * crease.across();
    }
    double beside(const Eigen::Vector2d& u) const { return across.dot(u - middle); }
};

TEST(FollowStretches, FindsAnEdgeThatIsMovedAndTurnedWithinATenthOfAPixel)
{
    for (const double offset : {-8.7, -3.3, 0.0, 0.4, 2.5, 6.1})
        for (const double turn : {-2.0, 0.0, 0.7})
            for (const double step : {-0.35, 0.1, 0.6}) {
                const TrueEdge edge(offset, turn);
                const auto image = with_noise(
                    drawn([&](const auto& u) { return 0.45 + (edge.beside(u) > 0.0 ? 0.5 : -0.5) * step; }), 2.0);
                const auto matches = follow(image);
                ASSERT_EQ(matches.size(), 1u) << offset << " px, " << turn << " deg, step " << step;
                const Segment& found = matches[0].segment;
                EXPECT_NEAR(edge.beside(found.a), 0.0, 0.1) << offset << " px, " << turn << " deg, step " << step;
                EXPECT_NEAR(edge.beside(found.b), 0.0, 0.1) << offset << " px, " << turn << " deg, step " << step;
                EXPECT_GT(found.length(), 0.95 * (Crease{}.to - Crease{}.from).norm());
                EXPECT_GT((found.b - found.a).dot(Crease{}.along()), 0.0) << "in the direction of the crease";
            }
}

TEST(FollowStretches, FindsNothingWithoutAnEdge)
{
    EXPECT_TRUE(follow(GrayImage(200, 160, 0.5f)).empty());
    EXPECT_TRUE(follow(with_noise(GrayImage(200, 160, 0.5f), 3.0)).empty());
    EXPECT_TRUE(follow(with_noise(GrayImage(200, 160, 0.5f), 30.0)).empty()) << "noise that is all edges";
}

TEST(FollowStretches, FindsNoEdgeWhosePolarityChangesOnTheWay)
{
    const Crease crease;
    const auto image = drawn([&](const auto& u) {
        const bool odd = static_cast<int>(std::floor(crease.along().dot(u - crease.from) / 12.0)) % 2 != 0;
        return (crease.beside(u) > 0.0) == odd ? 0.3 : 0.7;
    });
    for (auto& m : follow(image))
        std::printf("ALT %g %g %g %g  %g %g\n", m.segment.a.x(), m.segment.a.y(), m.segment.b.x(), m.segment.b.y(),
                    crease.beside(m.segment.a), crease.beside(m.segment.b));
    EXPECT_TRUE(follow(image).empty()) << "each piece is too short, and together they are no edge";
}

TEST(FollowStretches, FindsNoEdgeBeyondItsReachOrAcross)
{
    const Crease crease;
    EXPECT_TRUE(follow(drawn([&](const auto& u) { return crease.beside(u) > 14.0 ? 0.3 : 0.7; })).empty());
    EXPECT_TRUE(follow(drawn([&](const auto& u) { return u.x() > 100.0 ? 0.3 : 0.7; })).empty());
    const TrueEdge steep(0.0, 8.0);
    EXPECT_TRUE(follow(drawn([&](const auto& u) { return steep.beside(u) > 0.0 ? 0.3 : 0.7; })).empty())
        << "turned by more than match_angle";
}

TEST(FollowStretches, TakesTheNearerOfTwoEqualEdges)
{
    const Crease crease;
    for (const double side : {-1.0, 1.0}) {
        const auto matches = follow(drawn([&](const auto& u) {
            const double d = side * crease.beside(u);
            return d < -7.0 || d > 3.0 ? 0.3 : 0.7;
        }));
        ASSERT_EQ(matches.size(), 1u);
        EXPECT_NEAR(side * crease.beside(matches[0].segment.a), 3.0, 0.1);
        EXPECT_NEAR(matches[0].distance, 3.0, 0.1);
    }
}

TEST(FollowStretches, TakesTheEdgeToWhichAllCreasesAreShifted)
{
    // The photograph lies (2, 6) px beside where the pose puts it, and 3 px above the upper crease is another edge.
    const auto image = drawn([](const Eigen::Vector2d& u) {
        if (u.y() < 80.0) return u.y() > 37.0 && u.y() < 46.0 ? 0.3 : 0.7;
        return u.x() < 125.0 ? (u.y() > 116.0 ? 0.3 : 0.7) : (u.x() > 152.0 ? 0.3 : 0.7);
    });
    const Crease upper{{20.0, 40.0}, {180.0, 40.0}}, left{{20.0, 110.0}, {100.0, 110.0}},
        right{{150.0, 95.0}, {150.0, 150.0}};
    const auto alone = follow(image, {upper});
    ASSERT_EQ(alone.size(), 1u);
    EXPECT_NEAR(alone[0].segment.a.y(), 37.0, 0.1);
    const auto together = follow(image, {upper, left, right});
    ASSERT_EQ(together.size(), 3u);
    EXPECT_NEAR(together[0].segment.a.y(), 46.0, 0.1);
    EXPECT_NEAR(together[1].segment.a.y(), 116.0, 0.1);
    EXPECT_NEAR(together[2].segment.a.x(), 152.0, 0.1);
}

TEST(FollowStretches, EndsWhereTheEdgeDoes)
{
    const Crease crease;
    const auto image = drawn([&](const auto& u) {
        const double s = crease.along().dot(u - crease.from);
        return s < 70.0 && crease.beside(u) > 0.0 ? 0.3 : 0.7; // something without edges hides the rest
    });
    const auto matches = follow(image);
    ASSERT_EQ(matches.size(), 1u);
    EXPECT_NEAR(crease.along().dot(matches[0].segment.b - crease.from), 70.0, 3.0);
    EXPECT_NEAR(crease.beside(matches[0].segment.b), 0.0, 0.15);
}

TEST(FollowStretches, GivesOneEdgeToTheNearestOfSeveralCreases)
{
    const Crease crease;
    Crease beside = crease;
    for (Eigen::Vector2d* end : {&beside.from, &beside.to})
        *end += 6.0 * crease.across();
    const auto image = drawn([&](const auto& u) { return crease.beside(u) > 1.0 ? 0.3 : 0.7; });
    for (const bool swapped : {false, true}) {
        const auto matches =
            follow(image, swapped ? std::vector<Crease>{beside, crease} : std::vector<Crease>{crease, beside});
        ASSERT_EQ(matches.size(), 1u);
        EXPECT_NEAR(matches[0].distance, 1.0, 0.1);
    }
}

TEST(FollowStretches, SeesEdgesBesideTheImageBorder)
{
    Crease crease;
    crease.from = {3.0, 20.0};
    crease.to = {3.0, 140.0};
    const auto matches = follow(drawn([](const auto& u) { return u.x() > 5.2 ? 0.3 : 0.7; }), {crease});
    ASSERT_EQ(matches.size(), 1u);
    EXPECT_NEAR(matches[0].segment.a.x(), 5.2, 0.1);
    EXPECT_TRUE(follow(GrayImage(200, 160, 0.5f), {crease}).empty()) << "the border itself is no edge";
}

SynthParams small_room()
{
    SynthParams params;
    params.texel_size = 0.005;
    params.furniture = 5;
    params.truth_samples = 0;
    return params;
}

// A furnished room, its true creases, and photographs from a few places of a hand-held path.
struct Furnished {
    SynthParams params = small_room();
    PaintedRoom room;
    std::vector<Rigid> world_from_camera;
    GroundTruth truth;
    PlaneMesh mesh;
    std::vector<StraightBorder> borders;

    Furnished() : room(paint_room(furnish_room(params), params.texel_size))
    {
        std::vector<quoin::View> views;
        for (std::size_t i = 0; const Rigid& pose : hand_held_path(params))
            if (i++ % 25 == 0) {
                world_from_camera.push_back(pose);
                views.push_back({sensor_camera(params), pose});
            }
        truth = survey_room(room, views, params);
        mesh.mesh = truth.mesh;
        mesh.face_plane = truth.face_plane;
        for (const TrueCrease& crease : truth.crease)
            borders.push_back({crease.planes, crease.ends});
    }

    GrayImage photograph(const Rigid& pose) const
    {
        const ColorField field = render_color(room, {sensor_camera(params), pose});
        GrayImage gray(field.width, field.height);
        std::ranges::transform(field.pixels, gray.pixels.begin(),
                               [](const auto& c) { return c.dot(Eigen::Vector3f(0.299f, 0.587f, 0.114f)) / 255.0f; });
        return with_noise(std::move(gray), 2.0);
    }
};

double share_below(const std::vector<double>& values, double limit)
{
    return static_cast<double>(std::ranges::count_if(values, [&](double value) { return value < limit; })) /
           static_cast<double>(values.size());
}

TEST(FollowStretches, RecoversTheTrueCreasesOfAFurnishedRoomFromWrongPoses)
{
    const Furnished scene;
    const Camera camera = sensor_camera(scene.params);
    Rigid error = Rigid::Identity();
    error.rotate(Eigen::AngleAxisd(0.6 / kRadian, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()));
    error.translation() = Eigen::Vector3d(0.008, -0.006, 0.004);
    std::vector<double> off_by, guess_off_by; // [px]
    for (const Rigid& pose : scene.world_from_camera) {
        const Rigid true_camera_from_world = pose.inverse(), guess = error * true_camera_from_world;
        const MeshView view{camera, guess, rasterize(scene.mesh.mesh, camera, guess), &scene.mesh};
        const auto stretches = visible_stretches(scene.borders, view, guided());
        for (const auto& match : follow_stretches(scene.photograph(pose), stretches, view, guided())) {
            const Eigen::Vector2d a = camera.project(true_camera_from_world * match.ends[0]),
                                  b = camera.project(true_camera_from_world * match.ends[1]);
            const Eigen::Vector2d along = (b - a).normalized(), across(-along.y(), along.x());
            off_by.push_back(
                std::max(std::abs(across.dot(match.segment.a - a)), std::abs(across.dot(match.segment.b - a))));
            guess_off_by.push_back(match.distance);
        }
    }
    EXPECT_GT(off_by.size(), 120u);
    EXPECT_GT(share_below(guess_off_by, 3.0), 0.2);
    EXPECT_LT(share_below(guess_off_by, 3.0), 0.5) << "the poses are wrong by several pixels";
    EXPECT_GT(share_below(off_by, 0.3), 0.5);
    EXPECT_GT(share_below(off_by, 1.0), 0.8);
    EXPECT_GT(share_below(off_by, 2.0), 0.9);
}

} // namespace
} // namespace quoin
