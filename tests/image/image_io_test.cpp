#include "image/image_io.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <cstdlib>
#include <fstream>

namespace quoin {
namespace {

using test::error_of;
using testing::HasSubstr;

ColorImage colors(int width, int height)
{
    ColorImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(5 * y),
                              static_cast<std::uint8_t>(200 - x)};
    return image;
}

Image<std::uint16_t> depths(int width, int height)
{
    Image<std::uint16_t> image(width, height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = static_cast<std::uint16_t>(37 * i);
    image.pixels.front() = 65535;
    return image;
}

std::string refusal(const std::vector<std::byte>& bytes)
{
    return error_of([&] { decode_color(bytes, "a.jpg"); }, ExitCode::Input);
}

TEST(Png, KeepsEveryColourAndEveryDepth)
{
    EXPECT_EQ(decode_color(encode_png(colors(31, 17)), "a").pixels, colors(31, 17).pixels);
    EXPECT_EQ(decode_gray16(encode_png(depths(31, 17)), "a").pixels, depths(31, 17).pixels);
}

TEST(Png, GreyBecomesColourWithEqualChannels)
{
    const Image<std::uint8_t> gray(3, 2, 77);
    EXPECT_EQ(decode_color(encode_png(gray), "a").at(2, 1), (Rgb8{77, 77, 77}));
}

TEST(Jpeg, KeepsRedBesideBlueBecauseColourIsNotSubsampled)
{
    ColorImage stripes(32, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
            stripes.at(x, y) = x % 2 ? Rgb8{230, 20, 20} : Rgb8{20, 20, 230};
    const ColorImage decoded = decode_color(encode_jpeg(stripes, 95), "a");
    for (int x = 0; x < 32; ++x)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(decoded.at(x, 8)[c], stripes.at(x, 8)[c], 20);
}

TEST(Jpeg, LowerQualityIsSmaller)
{
    EXPECT_LT(encode_jpeg(colors(64, 48), 30).size(), encode_jpeg(colors(64, 48), 95).size());
}

TEST(DecodeGray, ReducesTheSizeAndKeepsTheMean)
{
    const Image<std::uint8_t> gray(64, 48, 51);
    for (const int reduction : {1, 2, 4}) {
        const GrayImage decoded = decode_gray(encode_png(gray), "a", reduction);
        EXPECT_EQ(decoded.width, 64 / reduction);
        EXPECT_EQ(decoded.height, 48 / reduction);
        EXPECT_NEAR(decoded.at(5, 5), 0.2f, 1e-6);
    }
}

TEST(InspectImage, TellsSizeAndKindFromTheHeader)
{
    const ImageInfo color = inspect_image(encode_jpeg(colors(40, 30), 90), "a.jpg");
    EXPECT_EQ(color.width, 40);
    EXPECT_EQ(color.height, 30);
    EXPECT_EQ(color.channels, 3);
    EXPECT_EQ(color.bits, 8);
    const ImageInfo depth = inspect_image(encode_png(depths(20, 10)), "a.png");
    EXPECT_EQ(depth.channels, 1);
    EXPECT_EQ(depth.bits, 16);
}

TEST(BadImages, EmptyCutOffAndForeignFilesAreEachCalledByTheirName)
{
    EXPECT_THAT(refusal({}), testing::AllOf(HasSubstr("a.jpg"), HasSubstr("empty")));
    for (std::vector<std::byte> bytes : {encode_jpeg(colors(64, 48), 90), encode_png(colors(64, 48))}) {
        bytes.resize(bytes.size() / 2);
        EXPECT_THAT(refusal(bytes), HasSubstr("cut off"));
        EXPECT_THAT(error_of([&] { inspect_image(bytes, "a.jpg"); }, ExitCode::Input), HasSubstr("cut off"));
    }
    const std::vector<std::byte> text(200, std::byte{'x'});
    EXPECT_THAT(refusal(text), HasSubstr("not an image"));
    EXPECT_THAT(error_of([&] { inspect_image(text, "a.jpg"); }, ExitCode::Input), HasSubstr("not an image"));
}

TEST(BadImages, DepthOf8BitsAndColourOf16BitsAreRefused)
{
    EXPECT_THAT(error_of([] { decode_gray16(encode_png(Image<std::uint8_t>(4, 4, 1)), "d.png"); }, ExitCode::Input),
                HasSubstr("16 bits"));
    EXPECT_THAT(refusal(encode_png(depths(4, 4))), HasSubstr("8 bits"));
}

TEST(ImageFiles, AreWrittenReadAndNamedWhenMissing)
{
    const test::TemporaryFolder folder;
    write_png(folder.path() / "a.png", colors(9, 7));
    EXPECT_EQ(read_color(folder.path() / "a.png").pixels, colors(9, 7).pixels);
    EXPECT_THAT(error_of([&] { read_color(folder.path() / "b.png"); }, ExitCode::Input), HasSubstr("b.png"));
    EXPECT_THAT(error_of([&] { read_bytes(folder.path()); }, ExitCode::Input), HasSubstr("directory"));
    EXPECT_THAT(error_of([&] { read_gray16(folder.path() / "a.png"); }, ExitCode::Input), HasSubstr("a.png"));
}

} // namespace
} // namespace quoin
