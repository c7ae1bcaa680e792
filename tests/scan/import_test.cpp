#include "scan/import.h"

#include "base/parallel.h"
#include "scan/digest.h"
#include "support/expect_error.h"
#include "tiny_scan.h"

#include <numbers>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using namespace test;
using testing::AllOf, testing::HasSubstr;

std::string refusal(const fs::path& folder, const ImportParams& params = {})
{
    return error_of([&] { import_scan(folder, params); }, ExitCode::Input);
}

class ImportTest : public testing::Test {
protected:
    void SetUp() override { write_seven_scenes(folder_, walk(8)); }
    const fs::path& path() const { return folder_.path(); }
    ImportedScan import(const ImportParams& params = {}) const { return import_scan(path(), params); }
    ScanFolder folder_;
};

TEST_F(ImportTest, EveryFileHasTheDigestOfItsBytes)
{
    const Scan scan = import().scan;
    EXPECT_EQ(scan.frames[2].color.sha256, sha256(read_bytes(path() / "frame-000002.color.jpg")));
    EXPECT_EQ(scan.frames[2].depth.sha256, sha256(read_bytes(path() / "frame-000002.depth.png")));
}

TEST_F(ImportTest, StepAndLimitThinTheFrames)
{
    ImportParams params;
    params.frame_step = 3;
    params.max_frames = 2;
    const Scan scan = import(params).scan;
    ASSERT_EQ(scan.frames.size(), 2u);
    EXPECT_EQ(scan.frames[1].color.name, "frame-000003.color.jpg");
}

TEST_F(ImportTest, EveryNthFrameIsHeldOut)
{
    ImportParams params;
    params.hold_out = 4;
    const ImportedScan imported = import(params);
    EXPECT_THAT(imported.scan.frames_held_out(), testing::ElementsAre(3u, 7u));
    EXPECT_EQ(imported.report.used, 6u);
    EXPECT_EQ(imported.report.held_out, 2u);
}

TEST_F(ImportTest, ParametersReplaceTheCameraOfTheScanAndOnlyTheOneTheyName)
{
    ImportParams params;
    params.color_fx = 51.0;
    params.color_k1 = -0.03;
    params.color_depth_tx = 0.025;
    params.color_depth_ry = 90.0;
    params.max_depth = 2.5;
    const Scan scan = import(params).scan;
    EXPECT_EQ(scan.color.fx, 51.0);
    EXPECT_EQ(scan.color.fy, 50.0);
    EXPECT_EQ(scan.color.k1, -0.03);
    EXPECT_EQ(scan.depth.fx, 50.0);
    EXPECT_EQ(scan.depth.k1, 0.0);
    EXPECT_EQ(scan.max_depth, 2.5);
    EXPECT_LT((scan.depth_from_color * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1.025, 0, 0)).norm(), 1e-12);
}

TEST_F(ImportTest, InvalidPosesAreCountedAndNotUsed)
{
    folder_.write("frame-000001.pose.txt",
                  "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
    folder_.write("frame-000002.pose.txt", "nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    folder_.write("frame-000003.pose.txt", "2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n");
    folder_.write("frame-000004.pose.txt", "1 0 0\n");
    fs::remove(path() / "frame-000005.pose.txt");
    const ImportedScan imported = import();
    EXPECT_EQ(imported.report.invalid, 5u);
    EXPECT_EQ(imported.report.invalid_example, "frame-000001.color.jpg");
    EXPECT_THAT(imported.scan.frames_in_use(), testing::ElementsAre(0u, 6u, 7u));
}

TEST_F(ImportTest, InvalidPosesEverywhereAreAnError)
{
    for (int i = 0; i < 8; ++i)
        folder_.write(frame_name(static_cast<std::size_t>(i), "pose.txt"), "nan");
    EXPECT_THAT(refusal(path()), AllOf(HasSubstr("none of the 8 frames has a valid pose"), HasSubstr("frame-000000")));
}

TEST_F(ImportTest, AFrameMayLackDepthButNotAllOfThem)
{
    fs::remove(path() / "frame-000002.depth.png");
    const ImportedScan imported = import();
    EXPECT_EQ(imported.report.without_depth, 1u);
    EXPECT_TRUE(ScanImages(imported.scan, path()).depth(2).empty());
    for (int i = 0; i < 8; ++i)
        fs::remove(path() / frame_name(static_cast<std::size_t>(i), "depth.png"));
    EXPECT_THAT(refusal(path()), HasSubstr("none of the 8 frames has a depth image"));
}

TEST_F(ImportTest, TheLargestMeshOfTheFolderIsTheDenseMesh)
{
    EXPECT_EQ(import().scan.dense_mesh.name, "");
    folder_.write("small.ply", "ply");
    folder_.write("large.ply", "ply and more");
    const Scan scan = import().scan;
    EXPECT_EQ(scan.dense_mesh.name, "large.ply");
    EXPECT_EQ(scan.dense_mesh.sha256, sha256(read_bytes(path() / "large.ply")));
    ImportParams params;
    params.dense_mesh = "small.ply";
    EXPECT_EQ(import(params).scan.dense_mesh.name, "small.ply");
    params.dense_mesh = "none";
    EXPECT_EQ(import(params).scan.dense_mesh.name, "");
    params.dense_mesh = "absent.ply";
    EXPECT_THAT(refusal(path(), params), HasSubstr("absent.ply"));
}

TEST_F(ImportTest, GivesTheSameScanForAnyNumberOfThreads)
{
    set_thread_count(1);
    const ImportedScan one = import();
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        const ImportedScan many = import();
        for (std::size_t i = 0; i < one.scan.frames.size(); ++i) {
            EXPECT_EQ(many.scan.frames[i].color.sha256, one.scan.frames[i].color.sha256);
            EXPECT_EQ(many.scan.frames[i].camera_from_world.matrix(), one.scan.frames[i].camera_from_world.matrix());
        }
        EXPECT_EQ(many.report.check.median, one.report.check.median);
    }
    set_thread_count(0);
}

TEST(ImportCheck, ComparesFramesThatSeeTheSameHoweverFastTheCameraTurns)
{
    const ScanFolder folder;
    std::vector<Eigen::Matrix4d> poses;
    for (int i = 0; i < 50; ++i) { // 120 degrees in the 0.67 s that pairs are apart
        Rigid world_from_camera = Rigid::Identity();
        world_from_camera.linear() = Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitY()).toRotationMatrix();
        world_from_camera.translation() << 0.01 * i, 0.1, 0.2;
        poses.push_back(world_from_camera.matrix());
    }
    write_seven_scenes(folder, poses);
    const ImportReport report = import_scan(folder.path(), {}).report;
    EXPECT_GT(report.check.samples, report.check.pairs * 5);
    EXPECT_LT(report.check.relative, 0.02);
    EXPECT_EQ(report.suggestion, "");
}

TEST(ImportErrors, MissingEmptyAndUnknownFoldersSayWhatWasExpected)
{
    const TemporaryFolder folder;
    EXPECT_THAT(refusal(folder / "none"), HasSubstr("no such folder"));
    EXPECT_THAT(refusal(folder.path()), HasSubstr("empty"));
    write_atomically(folder / "notes.txt", std::string_view("hello"));
    EXPECT_THAT(refusal(folder / "notes.txt"), HasSubstr("not a folder"));
    EXPECT_THAT(refusal(folder.path()),
                AllOf(HasSubstr("bundlefusion"), HasSubstr("groundtruth.txt"), HasSubstr("trajectory.log")));
    ImportParams params;
    params.layout = Layout::Tum;
    EXPECT_THAT(refusal(folder.path(), params), AllOf(HasSubstr("TUM"), HasSubstr("groundtruth.txt")));
}

TEST(ImportErrors, AListThatNamesOnlyAbsentFilesIsRefusedWithAnExample)
{
    const ScanFolder folder;
    folder.write("rgb.txt", "1.0 rgb/a.png\n2.0 rgb/b.png\n");
    folder.write("depth.txt", "1.0 depth/a.png\n");
    folder.write("groundtruth.txt", "1.0 0 0 0 0 0 0 1\n");
    EXPECT_THAT(refusal(folder.path()), AllOf(HasSubstr("none of the 3 files"), HasSubstr("rgb/a.png")));
}

TEST_F(ImportTest, ATruncatedImageIsNamed)
{
    std::vector<std::byte> bytes = read_bytes(path() / "frame-000004.color.jpg");
    bytes.resize(bytes.size() / 2);
    folder_.write_bytes("frame-000004.color.jpg", bytes);
    EXPECT_THAT(refusal(path()), AllOf(HasSubstr("frame-000004.color.jpg"), HasSubstr("cut off")));
    folder_.write("frame-000004.color.jpg", "this is text");
    EXPECT_THAT(refusal(path()), AllOf(HasSubstr("frame-000004.color.jpg"), HasSubstr("not an image")));
}

TEST_F(ImportTest, ImagesOfSeveralSizesAndShallowDepthAreRefused)
{
    folder_.write_color("frame-000005.color.jpg", 32, 24);
    EXPECT_THAT(refusal(path()), AllOf(HasSubstr("frame-000005.color.jpg"), HasSubstr("32x24"), HasSubstr("64x48")));
    folder_.write_color("frame-000005.color.jpg");
    folder_.write_bytes("frame-000005.depth.png", encode_png(Image<std::uint8_t>(64, 48, 9)));
    EXPECT_THAT(refusal(path()), AllOf(HasSubstr("frame-000005.depth.png"), HasSubstr("16")));
}

TEST(ImportErrors, ColourOfAnotherSizeThanDepthNeedsBothCameras)
{
    const ScanFolder folder;
    write_seven_scenes(folder, walk(3));
    for (std::size_t i = 0; i < 3; ++i)
        folder.write_color(frame_name(i, "color.jpg"), 128, 96);
    EXPECT_THAT(refusal(folder.path()),
                AllOf(HasSubstr("depth camera is not known"), HasSubstr("64x48"), HasSubstr("--set depth_fx")));
    ImportParams params;
    params.depth_fx = params.depth_fy = 50.0;
    params.depth_cx = 31.5;
    params.depth_cy = 23.5;
    EXPECT_EQ(import_scan(folder.path(), params).scan.color.width, 128);
}

// A wrong convention is found and the flag that mends it is named.
struct WrongConvention {
    const char* name;
    ImportParams params;
    const char* flag;
};

class WrongConventions : public ImportTest, public testing::WithParamInterface<WrongConvention> {};

TEST_P(WrongConventions, AreFoundByReprojection)
{
    const ImportedScan imported = import(GetParam().params);
    EXPECT_EQ(imported.report.suggestion, GetParam().flag);
    EXPECT_LT(imported.report.suggested.relative * 2.0, imported.report.check.relative);
}

INSTANTIATE_TEST_SUITE_P(
    Flags, WrongConventions,
    testing::Values(WrongConvention{"pose", {.pose = PoseDirection::WorldToCamera}, "--set pose=camera_to_world"},
                    WrongConvention{
                        "axes", {.camera_axes = CameraAxes::YUpZBack}, "--set camera_axes=y_down_z_forward"},
                    WrongConvention{"flip", {.flip_y = FlipY::Yes}, "--set flip_y=no"},
                    WrongConvention{"unit", {.depth_unit = 0.005}, "--set depth_unit=0.001"}),
    [](const auto& param) { return param.param.name; });

TEST_F(ImportTest, SaysWhenNoConventionMakesTheDepthsAgree)
{
    EXPECT_FALSE(import().report.disagrees);
    for (std::size_t i = 0; i < 8; ++i) { // depth images that other poses saw
        Eigen::Matrix4d seen_from = walk(8)[(3 * i + 5) % 8];
        seen_from.topLeftCorner<3, 3>() *=
            Eigen::AngleAxisd(2.5 * static_cast<double>(i), Eigen::Vector3d::UnitY()).toRotationMatrix();
        folder_.write_depth(frame_name(i, "depth.png"), seen_from, 0.001);
    }
    const ImportReport report = import().report;
    EXPECT_TRUE(report.disagrees) << report.check.relative;
    EXPECT_EQ(report.suggestion, "");
    testing::internal::CaptureStderr();
    log_report(report);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("poses and depth images do not belong together"));
}

TEST(PoseConventions, AllGiveProperRotations)
{
    for (int bits = 0; bits < 8; ++bits) {
        const PoseConvention convention{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
        for (const Eigen::Matrix4d& pose : walk(3))
            EXPECT_TRUE(is_rigid(camera_from_world(pose, convention).matrix(), 1e-9));
    }
}

} // namespace
} // namespace quoin
