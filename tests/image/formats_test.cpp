// Files of every format beside OpenCV's reading of them.
#include "image/image_io.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace quoin {
namespace {

std::vector<std::byte> encoded(const cv::Mat& image, const std::string& extension, std::vector<int> options = {})
{
    std::vector<std::uint8_t> file;
    EXPECT_TRUE(cv::imencode(extension, image, file, options)) << extension;
    const auto bytes = std::as_bytes(std::span(file));
    return {bytes.begin(), bytes.end()};
}

cv::Mat decoded(const std::vector<std::byte>& file, int flags)
{
    const cv::Mat bytes(1, static_cast<int>(file.size()), CV_8U, const_cast<std::byte*>(file.data()));
    return cv::imdecode(bytes, flags);
}

// Colours and depths that change smoothly, with noise; the sizes are odd.
cv::Mat picture(int type, int width = 61, int height = 47)
{
    cv::Mat noise(height, width, type), smooth(5, 5, type);
    cv::RNG random(7);
    const double most = CV_MAT_DEPTH(type) == CV_16U ? 60'000 : 230;
    random.fill(smooth, cv::RNG::UNIFORM, 0, most);
    random.fill(noise, cv::RNG::UNIFORM, 0, most / 12);
    cv::Mat image;
    cv::resize(smooth, image, image.size(), width / 5.0, height / 5.0);
    cv::resize(image, image, noise.size());
    return image + noise;
}

struct File {
    std::string name;
    std::vector<std::byte> bytes;
};

std::vector<File> files_of_8_bits()
{
    std::vector<File> files;
    for (const auto& [kind, type] : {std::pair{"grey", CV_8UC1}, {"colour", CV_8UC3}, {"alpha", CV_8UC4}}) {
        files.push_back({std::string("PNG ") + kind, encoded(picture(type), ".png")});
        if (type == CV_8UC4) continue;
        for (const int progressive : {0, 1})
            files.push_back({std::string("JPEG ") + kind,
                             encoded(picture(type), ".jpg",
                                     {cv::IMWRITE_JPEG_QUALITY, 70, cv::IMWRITE_JPEG_PROGRESSIVE, progressive})});
        files.push_back({std::string("TIFF ") + kind, encoded(picture(type), ".tiff")});
        files.push_back({std::string("BMP ") + kind, encoded(picture(type), ".bmp")});
    }
    files.push_back({"WebP", encoded(picture(CV_8UC3), ".webp", {cv::IMWRITE_WEBP_QUALITY, 101})});
    return files;
}

TEST(Formats, ColoursAreThoseThatOpenCvReads)
{
    for (const auto& [name, file] : files_of_8_bits()) {
        cv::Mat expected;
        cv::cvtColor(decoded(file, cv::IMREAD_COLOR), expected, cv::COLOR_BGR2RGB);
        const ColorImage image = decode_color(file, name);
        ASSERT_EQ(cv::Size(image.width, image.height), expected.size()) << name;
        EXPECT_EQ(0, std::memcmp(image.pixels.data(), expected.data, 3 * expected.total())) << name;
    }
}

TEST(Formats, GreysOfEverySizeAreThoseThatOpenCvReads)
{
    const std::pair<int, int> reductions[] = {
        {1, cv::IMREAD_GRAYSCALE}, {2, cv::IMREAD_REDUCED_GRAYSCALE_2}, {4, cv::IMREAD_REDUCED_GRAYSCALE_4}};
    for (const auto& [name, file] : files_of_8_bits())
        for (const auto& [reduction, flags] : reductions) {
            const cv::Mat expected = decoded(file, flags);
            const GrayImage image = decode_gray(file, name, reduction);
            ASSERT_EQ(cv::Size(image.width, image.height), expected.size()) << name << " / " << reduction;
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x)
                    ASSERT_FLOAT_EQ(255.0f * image.at(x, y), expected.at<std::uint8_t>(y, x))
                        << name << " / " << reduction << " at " << x << ", " << y;
        }
}

TEST(Formats, DepthsOf16BitsAreReadFromPngAndTiff)
{
    const cv::Mat depth = picture(CV_16UC1);
    for (const char* format : {".png", ".tiff"}) {
        const auto image = decode_gray16(encoded(depth, format), format);
        ASSERT_EQ(cv::Size(image.width, image.height), depth.size());
        EXPECT_EQ(0, std::memcmp(image.pixels.data(), depth.data, 2 * depth.total())) << format;
    }
}

TEST(Formats, TheHeaderTellsSizeAndKind)
{
    for (const auto& [name, file] : files_of_8_bits()) {
        const ImageInfo info = inspect_image(file, name);
        EXPECT_EQ(std::pair(info.width, info.height), std::pair(61, 47)) << name;
        const int channels = name.ends_with("grey") ? 1 : name.ends_with("alpha") ? 4 : 3;
        EXPECT_EQ(info.channels, channels) << name;
        EXPECT_EQ(info.bits, 8) << name;
    }
    EXPECT_EQ(inspect_image(encoded(picture(CV_16UC1), ".tiff"), "depth").bits, 16);
    EXPECT_EQ(inspect_image(encoded(picture(CV_16UC3), ".png"), "depth").channels, 3);
}

} // namespace
} // namespace quoin
