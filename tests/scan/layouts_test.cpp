#include "base/error.h"
#include "scan/import.h"
#include "tiny_scan.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using namespace test;
using testing::HasSubstr;

ImportParams tiny_camera_params()
{
    ImportParams params;
    params.color_fx = params.depth_fx = kTinyCamera.fx;
    params.color_fy = params.depth_fy = kTinyCamera.fy;
    params.color_cx = params.depth_cx = kTinyCamera.cx;
    params.color_cy = params.depth_cy = kTinyCamera.cy;
    return params;
}

// Poses are those of the walk and depth agrees to a millimetre.
void expect_walk(const ImportedScan& imported, const std::vector<Eigen::Matrix4d>& poses)
{
    ASSERT_EQ(imported.scan.frames.size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_LT((imported.scan.frames[i].camera_from_world.inverse().matrix() - poses[i]).norm(), 1e-5)
            << "frame " << i;
    EXPECT_EQ(imported.report.used, poses.size());
    EXPECT_GT(imported.report.check.samples, 50u);
    EXPECT_LT(imported.report.check.median, 0.015); // a pixel is 2 cm of a slanted wall
    EXPECT_EQ(imported.report.suggestion, "");
}

TEST(SevenScenesLayout, ReadsFramesPosesAndIntrinsics)
{
    const ScanFolder folder;
    write_seven_scenes(folder, walk(6));
    const ImportedScan imported = import_scan(folder.path(), {});
    expect_walk(imported, walk(6));
    EXPECT_THAT(imported.report.layout, HasSubstr("7-Scenes"));
    EXPECT_EQ(imported.scan.color.fx, 50.0);
    EXPECT_EQ(imported.scan.depth.width, 64);
    EXPECT_EQ(imported.scan.depth_unit, 0.001);
    EXPECT_EQ(imported.scan.frames[3].color.name, "frame-000003.color.jpg");
    EXPECT_NEAR(imported.scan.frames[3].time, 0.1, 1e-12);
}

TEST(SevenScenesLayout, UsesThePublishedCameraOnlyForItsImageSize)
{
    const ScanFolder folder;
    write_seven_scenes(folder, walk(4));
    std::filesystem::remove(folder.path() / "camera-intrinsics.txt");
    expect_walk(import_scan(folder.path(), tiny_camera_params()), walk(4));
    EXPECT_THROW(import_scan(folder.path(), {}), InputError);
}

std::string info_text(const std::string& more = "")
{
    return "m_colorWidth = 128\nm_colorHeight = 96\nm_depthWidth = 64\nm_depthHeight = 48\nm_depthShift = 2000\n"
           "m_calibrationColorIntrinsic = 100 0 63.5 0 0 100 47.5 0 0 0 1 0 0 0 0 1\n"
           "m_calibrationDepthIntrinsic = 50 0 31.5 0 0 50 23.5 0 0 0 1 0 0 0 0 1\n" +
           more;
}

void write_bundlefusion(const ScanFolder& folder, const std::string& info)
{
    const auto poses = walk(5);
    folder.write("info.txt", info);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        folder.write_color(frame_name(i, "color.jpg"), 128, 96);
        folder.write_depth(frame_name(i, "depth.png"), poses[i], 0.0005);
        folder.write(frame_name(i, "pose.txt"), matrix_text(poses[i]));
    }
}

TEST(BundleFusionLayout, ReadsTwoCamerasOfDifferentSizeAndTheDepthShift)
{
    const ScanFolder folder;
    write_bundlefusion(folder, info_text());
    const ImportedScan imported = import_scan(folder.path(), {});
    expect_walk(imported, walk(5));
    EXPECT_EQ(imported.scan.color.fx, 100.0);
    EXPECT_EQ(imported.scan.color.width, 128);
    EXPECT_EQ(imported.scan.depth.cx, 31.5);
    EXPECT_EQ(imported.scan.depth_unit, 0.0005);
    EXPECT_TRUE(imported.scan.depth_from_color.matrix().isIdentity(1e-12));
}

TEST(BundleFusionLayout, TakesTheColourExtrinsicAsDepthFromColour)
{
    const ScanFolder folder;
    write_bundlefusion(folder, info_text("m_calibrationColorExtrinsic = 1 0 0 0.025 0 1 0 0 0 0 1 -0.01 0 0 0 1\n"));
    const Rigid depth_from_color = import_scan(folder.path(), {}).scan.depth_from_color;
    EXPECT_LT((depth_from_color.translation() - Eigen::Vector3d(0.025, 0, -0.01)).norm(), 1e-12);
}

TEST(IclNuimLayout, TurnsANegativeFyIntoFlippedPosesThatStayRotations)
{
    const ScanFolder folder;
    const Eigen::Vector4d flip(1, -1, 1, 1);
    std::string list, truth;
    const auto poses = walk(6);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::string id = std::to_string(i + 1);
        folder.write_color("rgb/" + id + ".png");
        folder.write_depth("depth/" + id + ".png", poses[i], 0.0002);
        list += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", id);
        truth += tum_line(id, flip.asDiagonal() * poses[i] * flip.asDiagonal());
    }
    folder.write("associations.txt", list);
    folder.write("livingRoom0.gt.freiburg", truth);
    const ImportedScan imported = import_scan(folder.path(), tiny_camera_params());
    expect_walk(imported, poses);
    EXPECT_THAT(imported.report.layout, HasSubstr("ICL-NUIM"));
    EXPECT_GT(imported.scan.depth.fy, 0.0);
    EXPECT_EQ(imported.scan.depth_unit, 0.0002);
}

TEST(IclNuimLayout, AFrameWithoutAPoseIsInvalidAndNotInterpolated)
{
    const ScanFolder folder;
    std::string list, truth;
    const auto poses = walk(4);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::string id = std::to_string(i + 1);
        folder.write_color("rgb/" + id + ".png");
        folder.write_depth("depth/" + id + ".png", poses[i], 0.0002);
        list += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", id);
        if (i != 1) truth += tum_line(id, poses[i]);
    }
    folder.write("associations.txt", list);
    folder.write("groundtruth.txt", truth);
    const ImportedScan imported = import_scan(folder.path(), tiny_camera_params());
    EXPECT_EQ(imported.scan.frames[1].use, FrameUse::Invalid);
    EXPECT_EQ(imported.report.invalid, 1u);
    EXPECT_EQ(imported.report.invalid_example, "rgb/2.png");
}

// Colour every 33 ms, depth 5 ms later, a trajectory of 100 Hz.
void write_tum(const ScanFolder& folder, const std::vector<Eigen::Matrix4d>& poses)
{
    std::string rgb = "# freiburg3_test\n", depth = "# depth\n", truth = "# time tx ty tz qx qy qz qw\n";
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const double time = 1000.0 + 0.033 * static_cast<double>(i);
        folder.write_color(fmt::format("rgb/{}.png", i));
        folder.write_depth(fmt::format("depth/{}.png", i), poses[i], 0.0002);
        rgb += fmt::format("{:.4f} rgb/{}.png\n", time, i);
        depth += fmt::format("{:.4f} depth/{}.png\n", time + 0.005, i);
        for (const double offset : {-0.004, 0.0, 0.004})
            truth += tum_line(fmt::format("{:.4f}", time + offset), poses[i]);
    }
    folder.write("rgb.txt", rgb);
    folder.write("depth.txt", depth);
    folder.write("groundtruth.txt", truth);
}

TEST(TumLayout, AssociatesColourDepthAndPoseByTime)
{
    const ScanFolder folder;
    write_tum(folder, walk(6));
    const ImportedScan imported = import_scan(folder.path(), tiny_camera_params());
    expect_walk(imported, walk(6));
    EXPECT_THAT(imported.report.intrinsics_source, HasSubstr("fr3"));
    EXPECT_EQ(imported.scan.frames[2].depth.name, "depth/2.png");
}

TEST(TumLayout, DepthTooFarInTimeIsNotTaken)
{
    const ScanFolder folder;
    write_tum(folder, walk(4));
    folder.write("depth.txt", "1000.0 depth/0.png\n1000.058 depth/1.png\n");
    const ImportedScan imported = import_scan(folder.path(), tiny_camera_params());
    EXPECT_EQ(imported.report.without_depth, 2u);
    EXPECT_EQ(imported.report.without_depth_example, "rgb/1.png");
    EXPECT_EQ(imported.scan.frames[1].depth.name, "");
    EXPECT_EQ(imported.scan.frames[2].depth.name, "depth/1.png");
}

TEST(TumLayout, DepthThatNoColourIsNearToIsAFrameOfItsOwn)
{
    const ScanFolder folder;
    write_tum(folder, walk(4));
    folder.write("rgb.txt", "1000.0 rgb/0.png\n1000.066 rgb/2.png\n");
    ImportParams params = tiny_camera_params();
    params.hold_out = 2;
    const ImportedScan imported = import_scan(folder.path(), params);
    ASSERT_EQ(imported.scan.frames.size(), 4u); // in order of time
    EXPECT_EQ(imported.scan.frames[1].color.name, "");
    EXPECT_EQ(imported.scan.frames[1].depth.name, "depth/1.png");
    EXPECT_TRUE(imported.scan.frames[1].camera_from_world.isApprox(Rigid(walk(4)[1]).inverse(), 1e-6));
    EXPECT_EQ(imported.report.without_color, 2u);
    EXPECT_EQ(imported.report.without_color_example, "depth/1.png");
    EXPECT_EQ(imported.scan.frames[2].use, FrameUse::HeldOut); // the second that has a colour image
    EXPECT_EQ(imported.scan.frames_held_out().size(), 1u);
    params.hold_out = 0;
    params.frame_step = 2; // of frames with colour, and of those without
    const ImportedScan every_other = import_scan(folder.path(), params);
    ASSERT_EQ(every_other.scan.frames.size(), 2u);
    EXPECT_EQ(every_other.scan.frames[0].name(), "rgb/0.png");
    EXPECT_EQ(every_other.scan.frames[1].name(), "depth/1.png");
}

TEST(TumLayout, FilesThatListsNameAndTheFolderLacksAreCounted)
{
    const ScanFolder folder;
    write_tum(folder, walk(5));
    std::filesystem::remove(folder.path() / "rgb/3.png");
    const ImportedScan imported = import_scan(folder.path(), tiny_camera_params());
    ASSERT_EQ(imported.scan.frames.size(), 5u);
    EXPECT_FALSE(imported.scan.frames[3].has_color()); // its depth is there
    EXPECT_EQ(imported.report.absent.count, 1u);
    EXPECT_EQ(imported.report.absent.named, 10u);
    EXPECT_EQ(imported.report.absent.example, "rgb/3.png");
}

TEST(RedwoodLayout, ReadsTheLogAndTheIntrinsicsOfOpen3d)
{
    const auto poses = walk(6);
    for (const std::string color : {"image", "color", "rgb"}) {
        const ScanFolder folder;
        std::string log;
        for (std::size_t i = 0; i < poses.size(); ++i) {
            folder.write_color(fmt::format("{}/{:05}.jpg", color, i));
            folder.write_depth(fmt::format("depth/{:05}.png", i), poses[i], 0.001);
            log += fmt::format("{} {} {}\n{}", i, i, i + 1, matrix_text(poses[i]));
        }
        folder.write("trajectory.log", log);
        folder.write("camera_intrinsic.json",
                     R"({"width": 64, "height": 48, "intrinsic_matrix": [50, 0, 0, 0, 50, 0, 31.5, 23.5, 1]})");
        expect_walk(import_scan(folder.path(), {}), poses);
    }
}

TEST(NumberedLayout, PairsImagesAndRowsByNumberAndReadsTheSettings)
{
    const ScanFolder folder;
    std::string rows;
    const auto poses = walk(6);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        folder.write_color(fmt::format("raw_imgs/{:04}_rgb_raw.jpg", i));
        folder.write_depth(fmt::format("depth_imgs/{:04}_depth_raw.png", i), poses[i], 0.0002);
        rows += tum_line(fmt::format("{}", 10.0 + 0.7 * static_cast<double>(i)), poses[i]);
    }
    folder.write("truth_cam_poses.txt", rows);
    folder.write("camera.yaml", "%YAML:1.0\n# camera\nCamera.fx: 50.0\nCamera.fy: 50.0\nCamera.cx: 31.5\nCamera.cy: "
                                "23.5\nDepthMapFactor: 5000.0\n");
    const ImportedScan imported = import_scan(folder.path(), {});
    expect_walk(imported, poses);
    EXPECT_EQ(imported.scan.depth_unit, 0.0002);
}

TEST(ScannerAppLayout, TurnsArkitAxesAndScalesTheDepthCamera)
{
    const ScanFolder folder;
    const auto poses = walk(6);
    const Eigen::Vector4d axes(1, -1, -1, 1);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Eigen::Matrix4d m = poses[i] * axes.asDiagonal();
        std::string numbers;
        for (int k = 0; k < 16; ++k)
            numbers += fmt::format("{}{}", k ? "," : "", m(k / 4, k % 4));
        folder.write(
            fmt::format("frame_{:05}.json", i),
            fmt::format(R"({{"cameraPoseARFrame": [{}], "intrinsics": [200,0,127.5,0,200,95.5,0,0,1], "time": {}}})",
                        numbers, 0.5 * static_cast<double>(i)));
        folder.write_color(fmt::format("frame_{:05}.jpg", i), 256, 192);
        folder.write_depth(fmt::format("depth_{:05}.png", i), poses[i], 0.001);
    }
    const ImportedScan imported = import_scan(folder.path(), {});
    expect_walk(imported, poses);
    EXPECT_EQ(imported.scan.color.fx, 200.0);
    EXPECT_EQ(imported.scan.depth.fx, 50.0);
    EXPECT_EQ(imported.scan.depth.cx, 31.5);
}

} // namespace
} // namespace quoin
