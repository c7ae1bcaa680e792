#include "image/sampling.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

GrayImage ramp(int width, int height)
{
    GrayImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = 0.01f * static_cast<float>(x) + 0.02f * static_cast<float>(y);
    return image;
}

TEST(SampleGray, OfARampIsTheRampWithItsSlopes)
{
    const GraySample sample = sample_gray(ramp(8, 8), 2.25, 5.5);
    EXPECT_NEAR(sample.value, 0.01 * 2.25 + 0.02 * 5.5, 1e-6);
    EXPECT_NEAR(sample.gx, 0.01, 1e-6);
    EXPECT_NEAR(sample.gy, 0.02, 1e-6);
}

TEST(SampleGray, GradientIsTheDerivativeOfTheSurface)
{
    GrayImage image(2, 2);
    image.pixels = {0.1f, 0.9f, 0.4f, 0.3f};
    const double x = 0.3, y = 0.6, h = 1e-3;
    const GraySample sample = sample_gray(image, x, y);
    EXPECT_NEAR(sample.gx, (sample_gray(image, x + h, y).value - sample_gray(image, x - h, y).value) / (2 * h), 1e-4);
    EXPECT_NEAR(sample.gy, (sample_gray(image, x, y + h).value - sample_gray(image, x, y - h).value) / (2 * h), 1e-4);
}

TEST(SampleColor, AtACentreIsThePixel)
{
    ColorImage image(3, 3);
    image.at(1, 1) = {10, 20, 30};
    EXPECT_EQ(sample_color(image, 1.0, 1.0), Eigen::Vector3f(10, 20, 30));
}

TEST(SampleColorCubic, GoesThroughThePixelsAndKeepsAConstant)
{
    ColorImage image(6, 6);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = {static_cast<std::uint8_t>(5 * i), 70, 200};
    for (const double x : {0.0, 2.0, 5.0}) // the border, too
        EXPECT_LT((sample_color_cubic(image, x, 3.0) - sample_color(image, x, 3.0)).norm(), 1e-3);
    const Eigen::Vector3f between = sample_color_cubic(image, 2.3, 2.8);
    EXPECT_NEAR(between[1], 70.0f, 1e-3);
    EXPECT_NEAR(between[2], 200.0f, 1e-3);
}

TEST(SampleColorCubic, IsSteeperAcrossAnEdgeThanAMeanOfTwo)
{
    ColorImage image(8, 4);
    for (int y = 0; y < 4; ++y)
        for (int x = 4; x < 8; ++x)
            image.at(x, y) = {200, 200, 200};
    const auto rise = [&](const auto& sample) { return sample(image, 3.75, 1.0)[0] - sample(image, 3.25, 1.0)[0]; };
    EXPECT_NEAR(rise(sample_color), 0.5 * 200, 1e-3);
    EXPECT_NEAR(rise(sample_color_cubic), 0.546875 * 200, 1e-3); // Keys's kernel with a = -0.75
}

TEST(HalfSize, OfARampIsTheRampAtTheMiddles)
{
    EXPECT_NEAR(half_size(ramp(8, 6)).at(1, 2), 0.01 * 2.5 + 0.02 * 4.5, 1e-6);
}

TEST(HalfDepth, TakesTheNearestValidAndNeverAverages)
{
    DepthImage depth(2, 2);
    depth.pixels = {0.0f, 3.0f, 1.0f, 0.0f};
    EXPECT_EQ(half_depth(depth).at(0, 0), 1.0f);
    depth.pixels = {0.0f, 0.0f, 0.0f, 0.0f};
    EXPECT_EQ(half_depth(depth).at(0, 0), 0.0f);
}

TEST(Smooth, KeepsAConstantAndSpreadsAPoint)
{
    const GrayImage constant(9, 9, 0.5f);
    for (const float value : smooth(constant, 1.5).pixels)
        EXPECT_NEAR(value, 0.5f, 1e-6);
    GrayImage point(15, 15);
    point.at(7, 7) = 1.0f;
    const GrayImage spread = smooth(point, 1.0);
    EXPECT_GT(spread.at(7, 7), spread.at(8, 7));
    EXPECT_FLOAT_EQ(spread.at(6, 7), spread.at(8, 7));
    float sum = 0.0f;
    for (const float value : spread.pixels)
        sum += value;
    EXPECT_NEAR(sum, 1.0f, 1e-5);
}

TEST(ToGray, WeighsGreenMostAndWhiteIsOne)
{
    ColorImage image(2, 1);
    image.pixels = {Rgb8{255, 255, 255}, Rgb8{0, 255, 0}};
    EXPECT_NEAR(to_gray(image).at(0, 0), 1.0, 1e-6);
    EXPECT_NEAR(to_gray(image).at(1, 0), 0.587, 1e-6);
}

} // namespace
} // namespace quoin
