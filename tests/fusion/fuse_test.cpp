#include "fusion/fuse.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "fusion/sensor.h"
#include "mesh/adjacency.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using ::testing::HasSubstr;
using testing::look_at;
using testing::RenderedScan;

const Eigen::Vector3d kHalfRoom{1.21, 0.83, 1.02}; // [m]

FuseParams coarse()
{
    FuseParams params;
    params.voxel_size = 0.03;
    params.truncation = 0.1;
    params.min_weight = 0.05;
    params.min_component_faces = 20;
    params.depth_edge = 0.1;
    return params;
}

RenderedScan wall()
{
    auto rendered = testing::scan_of(testing::plane_at_z(1.513));
    for (int i = 0; i < 3; ++i)
        rendered.add(look_at({0.1 * i, 0.05 * i, 0.02 * i}, {0.1 * i, 0, 1.5}));
    return rendered;
}

RenderedScan box_room()
{
    auto rendered = testing::scan_of(testing::room(kHalfRoom));
    rendered.scan.color.fx = rendered.scan.color.fy = rendered.scan.depth.fx = rendered.scan.depth.fy = 90.0;
    for (int turn = 0; turn < 12; ++turn) {
        const double angle = turn * M_PI / 6.0;
        for (const double down : {-1.0, 0.0, 1.0})
            rendered.add(look_at({0.1 * std::cos(angle), 0, 0.1}, {std::cos(angle), down, std::sin(angle) + 0.1}));
    }
    rendered.add(look_at({0, 0, 0.01}, {0, 1, 0}));
    rendered.add(look_at({0, 0, 0.01}, {0, -1, 0}));
    return rendered;
}

RenderedScan ball()
{
    auto rendered = testing::scan_of(testing::sphere({0.02, 0.01, 0}, 0.4));
    for (int turn = 0; turn < 10; ++turn)
        for (const double height : {-0.9, -0.3, 0.3, 0.9})
            rendered.add(look_at({std::cos(turn * M_PI / 5), height, std::sin(turn * M_PI / 5)}, {0, 0, 0}));
    rendered.add(look_at({0, 1.4, 0.01}, {0, 0, 0}));
    rendered.add(look_at({0, -1.4, 0.01}, {0, 0, 0}));
    return rendered;
}

TriangleMesh fused(const RenderedScan& rendered, const FuseParams& params)
{
    return fuse_frames(rendered.scan, rendered.source(), params);
}

struct Topology {
    std::size_t borders = 0, non_manifold = 0, inconsistent = 0;
    std::ptrdiff_t euler = 0;
};

Topology topology_of(const TriangleMesh& mesh)
{
    const auto opposite = opposite_half_edges(mesh);
    Topology topology;
    std::size_t pairs = 0;
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        if (opposite[h] == kBorderEdge)
            ++topology.borders;
        else if (opposite[h] == kNonManifoldEdge)
            ++topology.non_manifold;
        else {
            ++pairs;
            if (mesh.face[h / 3][h % 3] == mesh.face[opposite[h] / 3][opposite[h] % 3]) ++topology.inconsistent;
        }
    }
    topology.euler = static_cast<std::ptrdiff_t>(mesh.position.size()) -
                     static_cast<std::ptrdiff_t>(pairs / 2 + topology.borders) +
                     static_cast<std::ptrdiff_t>(mesh.face.size());
    return topology;
}

TEST(Fuse, PutsAPlaneWhereItIsWithinATenthOfAVoxel)
{
    const auto mesh = fused(wall(), coarse());
    ASSERT_GT(mesh.face.size(), 1000u);
    for (const auto& p : mesh.position)
        EXPECT_NEAR(p.z(), 1.513, 0.003);
}

TEST(Fuse, TurnsFacesTowardsTheCamera)
{
    const auto mesh = fused(wall(), coarse());
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        EXPECT_LT(face_normal(mesh, f).z(), -0.5);
}

TEST(Fuse, MakesABallOfEulerNumberTwoThatFacesOutwards)
{
    const auto mesh = fused(ball(), coarse());
    const auto topology = topology_of(mesh);
    EXPECT_EQ(topology.borders, 0u);
    EXPECT_EQ(topology.non_manifold, 0u);
    EXPECT_EQ(topology.inconsistent, 0u);
    EXPECT_EQ(topology.euler, 2);
    double volume = 0.0;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        volume += corner(mesh, f, 0).dot(area_vector(mesh, f)) / 6.0;
    EXPECT_NEAR(volume, 4.0 / 3.0 * M_PI * 0.064, 0.01);
}

TEST(Fuse, ClosesABoxRoomThatFacesInwards)
{
    const auto mesh = fused(box_room(), coarse());
    const auto topology = topology_of(mesh);
    EXPECT_EQ(topology.borders, 0u);
    EXPECT_EQ(topology.non_manifold, 0u);
    EXPECT_EQ(topology.inconsistent, 0u);
    EXPECT_EQ(topology.euler, 2);
    double area = 0.0, turned_away = 0.0; // slivers may be, where a vertex of the lattice is in the wall
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        area += face_area(mesh, f);
        if (area_vector(mesh, f).dot(corner(mesh, f, 0)) >= 0.0) turned_away += face_area(mesh, f);
    }
    EXPECT_LT(turned_away, 1e-4 * area);
}

TEST(Fuse, KeepsTheWallsOfABoxRoomWithinAThirdOfAVoxel)
{
    const auto mesh = fused(box_room(), coarse());
    for (const auto& p : mesh.position) {
        const Eigen::Vector3d gap = kHalfRoom - p.cast<double>().cwiseAbs();
        const bool near_crease = (gap.array() < 0.1).count() > 1;
        if (!near_crease) {
            EXPECT_LT(std::abs(gap.minCoeff()), 0.01) << p.transpose();
        }
    }
}

TEST(Fuse, GivesTheSameBytesForOneTwoAndFourThreads)
{
    const auto rendered = box_room();
    set_thread_count(1);
    const auto serial = fused(rendered, coarse());
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        const auto parallel = fused(rendered, coarse());
        EXPECT_EQ(parallel.position, serial.position);
        EXPECT_EQ(parallel.face, serial.face);
        EXPECT_EQ(parallel.color, serial.color);
    }
    set_thread_count(0);
}

TEST(Fuse, RemovesAFloaterAndKeepsTheWall)
{
    auto rendered = wall();
    rendered.shape = testing::nearest_of(testing::plane_at_z(1.513), testing::sphere({0.1, 0, 0.8}, 0.05));
    auto params = coarse();
    params.min_component_faces = 0;
    params.min_component_area = 0.0;
    const auto has_floater = [](const TriangleMesh& mesh) {
        return std::any_of(mesh.position.begin(), mesh.position.end(), [](const auto& p) { return p.z() < 1.2f; });
    };
    EXPECT_TRUE(has_floater(fused(rendered, params)));
    params.min_component_faces = 200;
    EXPECT_FALSE(has_floater(fused(rendered, params)));
    params.min_component_faces = 0;
    params.min_component_area = 0.05;
    EXPECT_FALSE(has_floater(fused(rendered, params)));
}

TEST(Fuse, CarvesAwayWhatLaterFramesSeeThrough)
{
    auto rendered = wall();
    const auto frame = rendered.scan.frames[0].camera_from_world;
    rendered.scan.frames.clear();
    for (int i = 0; i < 10; ++i)
        rendered.add(frame);
    const auto clean = rendered.source();
    auto ghostly = clean;
    ghostly.depth = [&](FrameId id) { // a ghost at half the distance in the first frame
        auto depth = clean.depth(id);
        if (id == 0)
            for (int y = 40; y < 80; ++y)
                for (int x = 40; x < 80; ++x)
                    depth.at(x, y) *= 0.5f;
        return depth;
    };
    auto params = coarse();
    params.min_component_faces = 0;
    for (const auto& p : fuse_frames(rendered.scan, ghostly, params).position)
        EXPECT_GT(p.z(), 1.4f);
}

TEST(Fuse, SkipsFramesWithoutDepthOrNotInUse)
{
    auto rendered = wall();
    const auto expected = fused(rendered, coarse());
    rendered.add(look_at({0, 0, 0}, {1, 0, 0}));
    rendered.scan.frames.back().depth.name.clear();
    rendered.add(look_at({0, 0, 0}, {1, 0, 1}));
    rendered.scan.frames.back().use = FrameUse::HeldOut;
    rendered.add(look_at({0, 0, 0}, {-1, 0, 1}));
    rendered.scan.frames.back().use = FrameUse::Invalid;
    const auto mesh = fused(rendered, coarse());
    EXPECT_EQ(mesh.position, expected.position);
    EXPECT_EQ(mesh.color, expected.color);
}

TEST(Fuse, TakesColourThroughTheColourCamera)
{
    auto rendered = wall();
    rendered.shape.color = [](const Eigen::Vector3d& p) { return p.x() < 0.1 ? Rgb8{250, 10, 10} : Rgb8{10, 10, 250}; };
    rendered.scan.color = {200, 200, 150.0, 150.0, 99.5, 99.5};
    rendered.scan.depth_from_color.translation() = Eigen::Vector3d(0.08, 0.02, 0);
    const auto mesh = fused(rendered, coarse());
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        const float x = mesh.position[v].x();
        if (std::abs(x - 0.1f) < 0.05f || std::abs(x - 0.1f) > 0.4f || std::abs(mesh.position[v].y()) > 0.3f) continue;
        EXPECT_NEAR(mesh.color[v][0], x < 0.1f ? 250 : 10, 3) << mesh.position[v].transpose();
    }
}

TEST(Fuse, DoesNotPaintAWallWithWhatHidesItFromTheColourCamera)
{
    auto rendered = testing::scan_of(testing::nearest_of(testing::plane_at_z(1.5), testing::sphere({0, 0, 0.8}, 0.1)));
    rendered.shape.color = [](const Eigen::Vector3d& p) { return p.z() < 1.4 ? Rgb8{255, 0, 0} : Rgb8{0, 255, 0}; };
    rendered.scan.depth_from_color.translation() = Eigen::Vector3d(0.15, 0, 0);
    rendered.add(look_at({0, 0, 0}, {0, 0, 1}));
    const auto mesh = fused(rendered, coarse());
    for (std::size_t v = 0; v < mesh.position.size(); ++v)
        if (mesh.position[v].z() > 1.4f) {
            EXPECT_LT(mesh.color[v][0], 30) << mesh.position[v].transpose();
        }
}

TEST(Fuse, OfFramesWithoutColourHasNoColours)
{
    auto rendered = wall();
    for (auto& frame : rendered.scan.frames)
        frame.color.name.clear();
    EXPECT_TRUE(fused(rendered, coarse()).color.empty());
}

TEST(Fuse, NamesAVoxelSizeThatFitsWhenTheMemoryLimitIsHit)
{
    auto params = coarse();
    params.voxel_size = 0.002;
    params.truncation = 0.04;
    params.memory_limit = 0.02;
    try {
        fused(wall(), params);
        FAIL() << "no error";
    } catch (const ResourceError& error) {
        EXPECT_THAT(error.what(), HasSubstr("voxel_size 0.002 m needs"));
        EXPECT_THAT(error.what(), HasSubstr("or take voxel_size 0.0"));
    }
}

// A far wall whose depths err by 6 cm to either side, as sensors do there.
TriangleMesh far_wall(double depth_noise)
{
    auto rendered = testing::scan_of(testing::plane_at_z(5.013));
    for (int i = 0; i < 6; ++i)
        rendered.add(look_at({0, 0, 0}, {0, 0, 5}));
    FrameSource source = rendered.source();
    source.depth = [depth = source.depth](FrameId id) {
        DepthImage image = depth(id);
        for (float& z : image.pixels)
            if (z > 0.0f) z += id % 2 == 0 ? 0.06f : -0.06f;
        return image;
    };
    auto params = coarse();
    params.truncation = 0.04;
    params.voxel_size = 0.02;
    params.min_weight = 0.0;
    params.depth_noise = depth_noise;
    return fuse_frames(rendered.scan, source, params);
}

TEST(Fuse, MakesOneSurfaceOfFarDepthsThatDifferByTheirNoise)
{
    const auto one = far_wall(0.0024), layers = far_wall(0.0);
    ASSERT_GT(one.face.size(), 1000u);
    for (const auto& p : one.position)
        EXPECT_NEAR(p.z(), 5.013, 0.01);
    const auto [low, high] = std::ranges::minmax(layers.position, {}, [](const auto& p) { return p.z(); });
    EXPECT_GT(high.z() - low.z(), 0.05f); // of which a fixed truncation makes two
}

TEST(Fuse, KeepsSurfaceOfLittleWeightWhereTheWholeScanWeighsLittle)
{
    auto rendered = testing::scan_of(testing::plane_at_z(2.513));
    rendered.add(look_at({0, 0, 0}, {0, 0, 1}));
    FuseParams params = coarse();
    params.min_weight = 0.5; // one view from there weighs 0.16
    EXPECT_GT(fused(rendered, params).face.size(), 500u);
    params.min_weight_share = 1000.0;
    EXPECT_THROW(fused(rendered, params), ImpossibleError);
}

TEST(Fuse, FailsClearlyWhereThereIsNothingToFuse)
{
    auto rendered = wall();
    auto params = coarse();
    params.min_depth = 2.0;
    EXPECT_THROW(fused(rendered, params), ImpossibleError);
    for (auto& frame : rendered.scan.frames)
        frame.depth.name.clear();
    EXPECT_THROW(fused(rendered, coarse()), ImpossibleError);
}

TEST(Fuse, NamesAFrameThatLiesOutsideTheWorld)
{
    auto rendered = wall();
    rendered.scan.frames[1].camera_from_world.translation().x() = 1e9;
    try {
        fused(rendered, coarse());
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("frame 1 lies at"));
    }
}

} // namespace
} // namespace quoin
