#include "base/parallel.h"
#include "image/sampling.h"
#include "scan/digest.h"
#include "scan/import.h"
#include "scan/undistortion.h"
#include "support/expect_error.h"
#include "tiny_scan.h"

namespace quoin {
namespace {

using namespace test;
using testing::HasSubstr;

class ScanImagesTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_seven_scenes(folder_, walk(2));
        scan_ = import_scan(folder_.path(), {}).scan;
    }
    ScanFolder folder_;
    Scan scan_;
};

TEST_F(ScanImagesTest, ReadsColourGreyAndDepth)
{
    const ScanImages images(scan_, folder_.path());
    EXPECT_EQ(images.color(0).width, 64);
    EXPECT_EQ(images.gray(0).pixels, to_gray(images.color(0)).pixels);
    EXPECT_EQ(images.recorded_gray(0, 2).width, 32);
    EXPECT_NEAR(images.depth(1).at(20, 10), room_depth(walk(2)[1]).at(20, 10), 0.0006);
}

TEST_F(ScanImagesTest, Depth0And65535AndBeyondTheLimitAreMissing)
{
    Image<std::uint16_t> raw(64, 48, 1000);
    raw.at(0, 0) = 0;
    raw.at(1, 0) = 65535;
    raw.at(2, 0) = 3000;
    raw.at(3, 0) = 2500;
    folder_.write_bytes("frame-000000.depth.png", encode_png(raw));
    scan_.frames[0].depth.sha256 = sha256(read_bytes(folder_.path() / "frame-000000.depth.png"));
    scan_.max_depth = 2.5;
    const DepthImage depth = ScanImages(scan_, folder_.path()).depth(0);
    EXPECT_EQ(depth.at(0, 0), 0.0f);
    EXPECT_EQ(depth.at(1, 0), 0.0f);
    EXPECT_EQ(depth.at(2, 0), 0.0f);
    EXPECT_EQ(depth.at(3, 0), 2.5f);
    EXPECT_EQ(depth.at(4, 0), 1.0f);
}

TEST_F(ScanImagesTest, AChangedOrMissingFileIsNamed)
{
    folder_.write_color("frame-000000.color.jpg", 64, 40);
    const ScanImages images(scan_, folder_.path());
    EXPECT_THAT(error_of([&] { images.color(0); }, ExitCode::Input),
                testing::AllOf(HasSubstr("frame-000000.color.jpg"), HasSubstr("SHA-256")));
    std::filesystem::remove(folder_.path() / "frame-000001.depth.png");
    EXPECT_THAT(error_of([&] { images.depth(1); }, ExitCode::Input), HasSubstr("frame-000001.depth.png"));
    EXPECT_THAT(error_of([&] { images.depth(2); }, ExitCode::Input), HasSubstr("2 frames"));
    EXPECT_THAT(error_of([&] { ScanImages(scan_, folder_.path() / "none"); }, ExitCode::Input),
                HasSubstr("--scan-root"));
}

TEST_F(ScanImagesTest, AnImageOfAnotherSizeThanTheCameraIsRefused)
{
    scan_.color.width = 100;
    EXPECT_THAT(error_of([&] { ScanImages(scan_, folder_.path()).color(0); }, ExitCode::Input), HasSubstr("64x48"));
}

TEST_F(ScanImagesTest, CanBeReadFromSeveralThreads)
{
    const ScanImages images(scan_, folder_.path());
    const ColorImage expected = images.color(0);
    parallel_for(16, [&](std::size_t) { EXPECT_EQ(images.color(0).pixels, expected.pixels); });
}

TEST(Undistortion, FollowsTheRadialModel)
{
    const Camera camera{64, 48, 50.0, 40.0, 31.5, 23.5, -0.2, 0.05};
    const Eigen::Vector2d pixel(51.5, 31.5); // x = 0.4, y = 0.2, r^2 = 0.2
    const double stretch = 1.0 - 0.2 * 0.2 + 0.05 * 0.04;
    EXPECT_LT((distorted_pixel(camera, pixel) - Eigen::Vector2d(31.5 + 20 * stretch, 23.5 + 8 * stretch)).norm(),
              1e-12);
}

// A wall with a smooth pattern, recorded by a distorting camera, looks as through a pinhole once undistorted.
TEST(Undistortion, GivesThePinholeImageOfASmoothPattern)
{
    const Camera camera{64, 48, 50.0, 50.0, 31.5, 23.5, -0.15, 0.02};
    const auto pattern = [](const Eigen::Vector2d& p) {
        return static_cast<std::uint8_t>(128.0 + 60.0 * std::sin(0.15 * p.x()) + 40.0 * std::cos(0.12 * p.y()));
    };
    ColorImage recorded(64, 48), pinhole(64, 48);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            Eigen::Vector2d source(x, y); // the inverse of the distortion, by fixed-point steps
            for (int i = 0; i < 30; ++i)
                source += Eigen::Vector2d(x, y) - distorted_pixel(camera, source);
            recorded.at(x, y).fill(pattern(source));
            pinhole.at(x, y).fill(pattern(Eigen::Vector2d(x, y)));
        }
    const ColorImage result = undistort(recorded, camera);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            EXPECT_NEAR(result.at(x, y)[0], pinhole.at(x, y)[0], 3);
}

TEST(Undistortion, TakesTheNearestDepthAndLeavesOutsideMissing)
{
    const Camera pincushion{64, 48, 50.0, 50.0, 31.5, 23.5, 0.3, 0.0};
    Image<std::uint16_t> depth(64, 48, 1000);
    for (int x = 32; x < 64; ++x)
        for (int y = 0; y < 48; ++y)
            depth.at(x, y) = 3000;
    for (const std::uint16_t value : undistort(depth, pincushion).pixels)
        EXPECT_TRUE(value == 0 || value == 1000 || value == 3000);
    EXPECT_EQ(undistort(depth, pincushion).at(0, 0), 0);
    EXPECT_EQ(undistort(depth, pincushion).at(31, 23), 1000);
}

TEST(Sha256, OfAbcIsThePublishedOne)
{
    const std::string text = "abc";
    const Sha256 digest = sha256(std::as_bytes(std::span(text)));
    EXPECT_EQ(digest[0], 0xba);
    EXPECT_EQ(digest[1], 0x78);
    EXPECT_EQ(digest[31], 0xad);
}

} // namespace
} // namespace quoin
