// The whole data path on scans that are no good: each ends with a model, or with one message that says why not.
#include "base/atomic_file.h"
#include "build_paths.h"
#include "image/image_io.h"
#include "support/command.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <gmock/gmock.h>
#include <memory>
#include <random>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kFrames = 12;

// A room scanned in 12 small frames; every test spoils a copy of it.
class BadScans : public testing::Test {
protected:
    static void SetUpTestSuite()
    {
        folder_ = std::make_unique<TemporaryFolder>();
        const CommandResult made = in_folder(
            "synthesize --out folder=room --set frames=12 --set width=160 --set height=120 --set focal=130"
            " --set room_width=3 --set room_length=3 --set furniture=1 --set texel_size=0.02 --set truth_samples=500"
            " --set truth_edge=1 --progress none");
        ASSERT_EQ(made.exit_code, 0) << made.output;
    }
    static void TearDownTestSuite() { folder_.reset(); }

    void SetUp() override
    {
        fs::remove_all(*folder_ / "bad");
        fs::remove_all(*folder_ / "out/bad");
        fs::copy(*folder_ / "room", *folder_ / "bad");
    }

    static CommandResult in_folder(const std::string& command)
    {
        return test::run_command("cd '" + folder_->path().string() +
                                 "' && unset QUOIN_STORE && " QUOIN_BINARY_DIR "/bin/" + command);
    }

    static CommandResult run(const std::string& options = "")
    {
        return in_folder("quoin run --scan bad --out out -S fuse.voxel_size=0.03 " + options);
    }

    static fs::path file(const std::string& name) { return *folder_ / "bad" / name; }
    static fs::path color(std::size_t i) { return file(fmt::format("frame-{:06}.color.jpg", i)); }
    static fs::path depth(std::size_t i) { return file(fmt::format("frame-{:06}.depth.png", i)); }
    static fs::path pose(std::size_t i) { return file(fmt::format("frame-{:06}.pose.txt", i)); }

    static void change_colors(const std::function<ColorImage(const ColorImage&)>& change)
    {
        for (std::size_t i = 0; i < kFrames; ++i)
            write_atomically(color(i), encode_jpeg(change(read_color(color(i))), 95));
    }

    static void expect_model(const CommandResult& result)
    {
        EXPECT_EQ(result.exit_code, 0) << result.output;
        EXPECT_GT(fs::file_size(*folder_ / "out/bad/model/model.glb"), 0u);
        EXPECT_THAT(result.output, Not(HasSubstr("nan"))) << "no figure of the evaluation is undefined";
    }

    inline static std::unique_ptr<TemporaryFolder> folder_;
};

// Every pixel gets the mean of its square of `side` px.
ColorImage in_squares(const ColorImage& image, int side)
{
    ColorImage result = image;
    for (int y0 = 0; y0 < image.height; y0 += side)
        for (int x0 = 0; x0 < image.width; x0 += side)
            for (std::size_t c = 0; c < 3; ++c) {
                int sum = 0;
                for (int i = 0; i < side * side; ++i)
                    sum += image.at(x0 + i % side, y0 + i / side)[c];
                for (int i = 0; i < side * side; ++i)
                    result.at(x0 + i % side, y0 + i / side)[c] = static_cast<std::uint8_t>(sum / (side * side));
            }
    return result;
}

TEST_F(BadScans, WithoutAnyTextureGiveAModel)
{
    change_colors([](const ColorImage& image) { return ColorImage(image.width, image.height, {225, 225, 225}); });
    const CommandResult result = run();
    expect_model(result);
    EXPECT_THAT(result.output, HasSubstr("next to no texture to align by"));
    EXPECT_THAT(result.output, HasSubstr("Poses stay as the depth has them"));
}

TEST_F(BadScans, OfSaturatedPhotographsGiveAModel)
{
    change_colors([](const ColorImage& image) { return ColorImage(image.width, image.height, {255, 255, 255}); });
    expect_model(run());
}

TEST_F(BadScans, OfBlurredPhotographsGiveAModel)
{
    change_colors([](const ColorImage& image) { return in_squares(image, 40); });
    expect_model(run());
}

TEST_F(BadScans, WithColourOfHalfTheSizeOfDepthGiveAModel)
{
    change_colors([](const ColorImage& image) {
        ColorImage half(image.width / 2, image.height / 2);
        const ColorImage squares = in_squares(image, 2);
        for (int y = 0; y < half.height; ++y)
            for (int x = 0; x < half.width; ++x)
                half.at(x, y) = squares.at(2 * x, 2 * y);
        return half;
    });
    expect_model(run("-S import.color_fx=65 -S import.color_fy=65 -S import.color_cx=39.5 -S import.color_cy=29.5"));
}

TEST_F(BadScans, WhosePosesJumpGiveAModelAndAWarning)
{
    for (std::size_t i = kFrames / 2; i < kFrames; ++i) {
        std::string text = read_text(pose(i)); // rows of 4; the 4th number is x of the position
        std::size_t begin = 0;
        for (int number = 0; number < 3; ++number)
            begin = text.find(' ', begin) + 1;
        const std::size_t end = text.find('\n', begin);
        text.replace(begin, end - begin, fmt::format("{:.9f}", std::stod(text.substr(begin, end - begin)) + 0.5));
        write_atomically(pose(i), std::as_bytes(std::span(text)));
    }
    const CommandResult result = run();
    expect_model(result);
    EXPECT_THAT(result.output, HasSubstr("poses and depth images do not belong together"));
}

TEST_F(BadScans, WhoseDepthsAreInAnotherOrderAreWarnedOf)
{
    std::vector<std::vector<std::byte>> files;
    for (std::size_t i = 0; i < kFrames; ++i)
        files.push_back(read_bytes(depth(i)));
    for (std::size_t i = 0; i < kFrames; ++i)
        write_atomically(depth(i), files[(5 * i + 3) % kFrames]);
    const CommandResult result = run();
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 5) << result.output;
    EXPECT_THAT(result.output, HasSubstr("poses and depth images do not belong together"));
}

TEST_F(BadScans, WhoseDepthIsNoiseHaveNoSurface)
{
    std::mt19937 random(1);
    std::uniform_int_distribution<int> millimetres(400, 5000);
    for (std::size_t i = 0; i < kFrames; ++i) {
        Image<std::uint16_t> noise = read_gray16(depth(i));
        std::ranges::generate(noise.pixels, [&] { return static_cast<std::uint16_t>(millimetres(random)); });
        write_atomically(depth(i), encode_png(noise));
    }
    const CommandResult result = run();
    EXPECT_EQ(result.exit_code, 5) << result.output;
    EXPECT_THAT(result.output, HasSubstr("no surface is left"));
}

TEST_F(BadScans, OfOneFrameGiveAModel)
{
    for (std::size_t i = 1; i < kFrames; ++i)
        for (const fs::path& path : {color(i), depth(i), pose(i)})
            fs::remove(path);
    expect_model(run());
}

TEST_F(BadScans, WithOneKeyframeGiveAModel) { expect_model(run("-S select-keyframes.interval=1000")); }

TEST_F(BadScans, WhoseTextureNeedsManyPagesGiveAModel)
{
    const CommandResult result = run("-S bake-texture.max_page_size=128 --log-level info");
    expect_model(result);
    EXPECT_THAT(result.output, HasSubstr("pages of at most 128 px"));
    EXPECT_TRUE(fs::exists(*folder_ / "out/bad/model/model_1.jpg"));
}

} // namespace
} // namespace quoin
