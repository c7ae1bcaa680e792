#include "base/parallel.h"
#include "image/sampling.h"
#include "keyframes/blur.h"
#include "keyframes/select_keyframes.h"
#include "scan/import.h"
#include "scan/tiny_scan.h"
#include "support/expect_error.h"

#include <cmath>
#include <numbers>

namespace quoin {
namespace {

using namespace test;
using testing::Each, testing::ElementsAre, testing::HasSubstr;

GrayImage gray_checkers() { return to_gray(checkers(96, 80)); }

// The metric as the paper writes it: filter, difference, sum.
double blur_by_definition(const GrayImage& F)
{
    const auto box = [&](int x, int y, int dx, int dy) {
        double sum = 0.0;
        for (int k = -4; k <= 4; ++k)
            sum += F.at(std::clamp(x + k * dx, 0, F.width - 1), std::clamp(y + k * dy, 0, F.height - 1));
        return sum / 9.0;
    };
    double worst = 0.0;
    for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
        double s_F = 0.0, s_V = 0.0;
        for (int y = 1; y < F.height; ++y)
            for (int x = 1; x < F.width; ++x) {
                const double D_F = std::abs(F.at(x, y) - F.at(x - dx, y - dy));
                const double D_B = std::abs(box(x, y, dx, dy) - box(x - dx, y - dy, dx, dy));
                s_F += D_F;
                s_V += std::max(0.0, D_F - D_B);
            }
        worst = std::max(worst, (s_F - s_V) / s_F);
    }
    return worst;
}

TEST(Blur, EqualsTheDefinitionOfThePaper)
{
    const GrayImage image = smooth(gray_checkers(), 1.2);
    EXPECT_NEAR(blur_of(image), blur_by_definition(image), 1e-5);
}

TEST(Blur, GrowsWithSmoothing)
{
    double last = blur_of(gray_checkers());
    for (const double sigma : {0.7, 1.5, 3.0}) {
        const double next = blur_of(smooth(gray_checkers(), sigma));
        EXPECT_GT(next, last);
        EXPECT_LE(next, 1.0);
        last = next;
    }
}

// A vertical edge differs along x only: sharp it is 1/9 (the box spreads it over nine pixels).
TEST(Blur, OfAVerticalEdgeIsOneNinthAndGrowsWhenItMoves)
{
    GrayImage sharp(64, 32), moved(64, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            sharp.at(x, y) = x < 32 ? 0.0f : 1.0f;
            moved.at(x, y) = std::clamp(static_cast<float>(x - 28) / 7.0f, 0.0f, 1.0f); // seven pixels of motion
        }
    EXPECT_NEAR(blur_of(sharp), 1.0 / 9.0, 1e-6);
    EXPECT_GT(blur_of(moved), 0.6);
}

TEST(Blur, OfAConstantOrEmptyOrTinyImageIsOne)
{
    EXPECT_EQ(blur_of(GrayImage(32, 32, 0.5f)), 1.0);
    EXPECT_EQ(blur_of(GrayImage()), 1.0);
    EXPECT_EQ(blur_of(GrayImage(1, 1, 0.5f)), 1.0);
}

// n frames that step along x by `step` metres and turn by `turn` radians, all with images.
Scan line_of_frames(int n, double step = 0.1, double turn = 0.1)
{
    Scan scan;
    for (int i = 0; i < n; ++i) {
        Frame frame;
        frame.color.name = frame.depth.name = std::to_string(i);
        frame.camera_from_world.linear() = Eigen::AngleAxisd(turn * i, Eigen::Vector3d::UnitY()).toRotationMatrix();
        frame.camera_from_world.translation() = frame.camera_from_world.linear() * Eigen::Vector3d(-step * i, 0, 0);
        scan.frames.push_back(frame);
    }
    return scan;
}

KeyframeParams only_interval(int interval)
{
    return {
        .interval = interval, .max_blur_deviation = 0.0, .min_translation = 0.0, .min_angle = 0.0, .max_keyframes = 0};
}

TEST(ChooseKeyframes, TakesTheSharpestOfEveryIntervalAndTheFirstAmongEquals)
{
    const Keyframes keyframes =
        choose_keyframes(line_of_frames(7), {0.5f, 0.3f, 0.4f, 0.2f, 0.2f, 0.9f, 0.8f}, only_interval(3));
    EXPECT_THAT(keyframes.frame, ElementsAre(1u, 3u, 6u)); // the last interval is shorter
    EXPECT_EQ(keyframes.reason[0], Dropped::NotSharpest);
    EXPECT_EQ(keyframes.reason[1], Dropped::Kept);
}

TEST(ChooseKeyframes, ReasonOfEveryUnusableFrameIsTold)
{
    Scan scan = line_of_frames(5);
    scan.frames[0].use = FrameUse::Invalid;
    scan.frames[1].use = FrameUse::HeldOut;
    scan.frames[2].color.name = "";
    scan.frames[3].depth.name = "";
    const float none = std::numeric_limits<float>::quiet_NaN();
    KeyframeParams params = only_interval(5);
    params.require_depth = true;
    const Keyframes keyframes = choose_keyframes(scan, {none, none, none, none, 0.5f}, params);
    EXPECT_THAT(keyframes.frame, ElementsAre(4u));
    EXPECT_THAT(keyframes.reason,
                ElementsAre(Dropped::InvalidPose, Dropped::HeldOut, Dropped::NoImage, Dropped::NoImage, Dropped::Kept));
}

TEST(ChooseKeyframes, AFrameWithoutDepthIsAllowed)
{
    Scan scan = line_of_frames(1);
    scan.frames[0].depth.name = "";
    EXPECT_EQ(choose_keyframes(scan, {0.5f}, only_interval(1)).frame.size(), 1u);
}

TEST(ChooseKeyframes, DropsFramesFarAboveTheMedianBlur)
{
    KeyframeParams params = only_interval(1);
    params.max_blur_deviation = 3.0;
    const Keyframes keyframes = choose_keyframes(line_of_frames(5), {0.30f, 0.31f, 0.32f, 0.33f, 0.60f}, params);
    EXPECT_EQ(keyframes.reason[4], Dropped::Blurred);
    EXPECT_EQ(keyframes.frame.size(), 4u);
}

TEST(ChooseKeyframes, EqualBlurDropsNothing)
{
    KeyframeParams params = only_interval(1);
    params.max_blur_deviation = 3.0;
    EXPECT_EQ(choose_keyframes(line_of_frames(4), {0.3f, 0.3f, 0.3f, 0.31f}, params).frame.size(), 4u);
}

TEST(ChooseKeyframes, APureTurnAndAPureStepAreKeptAStandstillIsDropped)
{
    KeyframeParams params = only_interval(1);
    params.min_translation = 0.05;
    params.min_angle = 5.0;
    const std::vector<float> blur(4, 0.3f);
    EXPECT_EQ(choose_keyframes(line_of_frames(4, 0.0, 0.2), blur, params).frame.size(), 4u) << "turn";
    EXPECT_EQ(choose_keyframes(line_of_frames(4, 0.1, 0.0), blur, params).frame.size(), 4u) << "step";
    const Keyframes still = choose_keyframes(line_of_frames(4, 0.001, 0.001), blur, params);
    EXPECT_THAT(still.frame, ElementsAre(0u));
    EXPECT_EQ(still.reason[2], Dropped::TooClose);
}

TEST(ChooseKeyframes, SlowMotionIsComparedWithTheFrameKeptLast)
{
    KeyframeParams params = only_interval(1);
    params.min_translation = 0.05;
    params.min_angle = 5.0;
    const Keyframes keyframes = choose_keyframes(line_of_frames(10, 0.02, 0.0), std::vector<float>(10, 0.3f), params);
    EXPECT_THAT(keyframes.frame, ElementsAre(0u, 3u, 6u, 9u));
}

TEST(ChooseKeyframes, ACapKeepsTheSharpestOfEqualGroups)
{
    KeyframeParams params = only_interval(1);
    params.max_keyframes = 2;
    const Keyframes keyframes = choose_keyframes(line_of_frames(6), {0.5f, 0.2f, 0.4f, 0.6f, 0.3f, 0.7f}, params);
    EXPECT_THAT(keyframes.frame, ElementsAre(1u, 4u));
    EXPECT_EQ(keyframes.reason[5], Dropped::OverLimit);
}

TEST(ChooseKeyframes, NoUsableFrameIsAnErrorThatSaysWhatToDo)
{
    Scan scan = line_of_frames(2);
    for (Frame& frame : scan.frames)
        frame.depth.name = "";
    KeyframeParams params = only_interval(1);
    params.require_depth = true;
    const auto choose = [&] { choose_keyframes(scan, std::vector<float>(2, NAN), params); };
    EXPECT_THAT(error_of(choose, ExitCode::Impossible), HasSubstr("require_depth=false"));
}

TEST(SelectKeyframes, FindsTheOneSharpFrameAndIsTheSameForAnyNumberOfThreads)
{
    const ScanFolder folder;
    write_seven_scenes(folder, walk(5));
    ColorImage soft = checkers(64, 48);
    for (int pass = 0; pass < 3; ++pass)
        for (int y = 0; y < 48; ++y)
            for (int x = 1; x < 64; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    soft.at(x, y)[c] = static_cast<std::uint8_t>((soft.at(x, y)[c] + soft.at(x - 1, y)[c]) / 2);
    for (const std::size_t i : {0, 1, 2, 4})
        folder.write_bytes(frame_name(i, "color.jpg"), encode_jpeg(soft, 95));
    const Scan scan = import_scan(folder.path(), {}).scan;
    const ScanImages images(scan, folder.path());
    set_thread_count(1);
    const Keyframes one = select_keyframes(images, only_interval(5));
    EXPECT_THAT(one.frame, ElementsAre(3u));
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        EXPECT_EQ(select_keyframes(images, only_interval(5)).blur, one.blur);
    }
    set_thread_count(0);
    for (const BlurScale scale : {BlurScale::Half, BlurScale::Quarter}) {
        KeyframeParams params = only_interval(5);
        params.blur_scale = scale;
        EXPECT_EQ(select_keyframes(images, params).frame.size(), 1u);
    }
}

} // namespace
} // namespace quoin
