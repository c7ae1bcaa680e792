#include "synth/synthesize.h"

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "image/image_io.h"
#include "mesh/ground_truth.h"
#include "support/temporary_folder.h"
#include "synth/camera_path.h"

#include <gmock/gmock.h>
#include <map>
#include <sstream>

namespace quoin {
namespace {

using test::TemporaryFolder;

SynthParams small_scan()
{
    SynthParams params;
    params.frames = 4;
    params.width = 96;
    params.height = 72;
    params.focal = 80.0;
    params.texel_size = 0.02;
    params.truth_samples = 2000;
    params.truth_edge = 1.0;
    params.furniture = 2;
    return params;
}

std::map<std::string, std::string> contents(const std::filesystem::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[std::filesystem::relative(entry.path(), folder).string()] = read_text(entry.path());
    return files;
}

Rigid read_pose(const std::filesystem::path& path)
{
    std::istringstream text(read_text(path));
    Rigid pose;
    for (int i = 0; i < 16; ++i)
        text >> pose.matrix()(i / 4, i % 4);
    return pose;
}

TEST(SynthesizeScan, GivesTheSameBytesForAnyNumberOfThreads)
{
    std::vector<std::map<std::string, std::string>> results;
    for (const int threads : {1, 2, 4}) {
        const TemporaryFolder folder;
        set_thread_count(threads);
        synthesize_scan(small_scan(), folder.path());
        results.push_back(contents(folder.path()));
    }
    set_thread_count(0);
    EXPECT_EQ(results[0].size(), 3u * 4u + 1u + 6u);
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

TEST(SynthesizeScan, MeasuresPointsOfTheTrueSurfaceWithoutErrors)
{
    SynthParams params = small_scan();
    params.furniture = 0;
    params.depth_noise = params.depth_step = params.pose_drift = params.pose_drift_angle = 0.0;
    const TemporaryFolder folder;
    synthesize_scan(params, folder.path());
    const GroundTruth truth = read_ground_truth(folder.path() / "ground_truth");
    const Camera camera = sensor_camera(params);
    const Image<std::uint16_t> depth = read_gray16(folder.path() / "frame-000002.depth.png");
    const Rigid world_from_camera = read_pose(folder.path() / "frame-000002.pose.txt");
    EXPECT_TRUE(world_from_camera.isApprox(truth.world_from_camera[2], 1e-6));
    int measured = 0;
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) {
            if (depth.at(x, y) == 0) continue;
            const Eigen::Vector3d point =
                world_from_camera * (camera.ray(Eigen::Vector2d(x, y)) * (0.001 * depth.at(x, y)));
            double nearest = 1.0;
            for (const TruePlane& plane : truth.plane)
                nearest = std::min(nearest, std::abs(plane.plane.signed_distance(point)));
            ASSERT_LT(nearest, 0.001) << "pixel " << x << " " << y << " at " << point.transpose();
            ++measured;
        }
    EXPECT_GT(measured, depth.width * depth.height / 2);
}

TEST(SynthesizeScan, SamplesLieOnTheirPlanesAndMostAreSeen)
{
    SynthParams params = small_scan();
    params.frames = 40;
    const TemporaryFolder folder;
    synthesize_scan(params, folder.path());
    const GroundTruth truth = read_ground_truth(folder.path() / "ground_truth");
    ASSERT_EQ(truth.sample.size(), 2000u);
    std::size_t seen = 0;
    for (const TrueSample& s : truth.sample) {
        if (s.plane != kNoPlane) {
            EXPECT_NEAR(truth.plane[s.plane].plane.signed_distance(s.position.cast<double>()), 0.0, 1e-5);
        }
        if (s.views > 0) ++seen;
    }
    EXPECT_GT(seen, 1500u);
    double area = 0.0, mesh_area = 0.0;
    for (const TruePlane& plane : truth.plane)
        area += plane.area;
    for (FaceId f = 0; f < truth.mesh.face.size(); ++f)
        mesh_area += face_area(truth.mesh, f);
    EXPECT_GT(mesh_area, area);
    EXPECT_LT(mesh_area, area + 1.0); // the ball
}

TEST(GroundTruth, ComesBackFromItsFolder)
{
    GroundTruth truth;
    truth.mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {}};
    truth.face_plane = {0};
    truth.plane = {{"floor", {Eigen::Vector3d::UnitZ(), 0.25}, 0.5}};
    truth.crease = {{{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0)}, {0, 3}, 1.5, true, true}};
    truth.time = {0.5};
    truth.world_from_camera = {Rigid(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()))};
    truth.exposure = {{{1.1, 1.0, 0.9}, {1, 2, 3}}};
    truth.sample = {{{0.1f, 0.2f, 0.0f}, {0, 0, 1}, {9, 8, 7}, kNoPlane, 4}};
    const TemporaryFolder folder;
    write_ground_truth(folder.path(), truth);
    const GroundTruth back = read_ground_truth(folder.path());
    EXPECT_EQ(back.mesh.face, truth.mesh.face);
    EXPECT_EQ(back.mesh.color, truth.mesh.color);
    EXPECT_EQ(back.plane[0].name, "floor");
    EXPECT_EQ(back.plane[0].plane.offset, 0.25);
    EXPECT_EQ(back.crease[0].planes, truth.crease[0].planes);
    EXPECT_TRUE(back.crease[0].concave && back.crease[0].observed);
    EXPECT_TRUE(back.world_from_camera[0].isApprox(truth.world_from_camera[0], 1e-8));
    EXPECT_EQ(back.exposure[0].bias, truth.exposure[0].bias);
    EXPECT_EQ(back.sample[0].plane, kNoPlane);
    EXPECT_EQ(back.sample[0].views, 4u);
}

} // namespace
} // namespace quoin
