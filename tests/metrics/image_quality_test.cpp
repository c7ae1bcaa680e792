#include "metrics/image_quality.h"

#include <cmath>
#include <gmock/gmock.h>

namespace quoin {
namespace {

constexpr int kSize = 48;

ColorImage pattern()
{
    ColorImage image(kSize, kSize);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const double wave = 110.0 + 50.0 * std::sin(0.7 * x) * std::cos(0.5 * y);
            image.at(x, y) = {static_cast<std::uint8_t>(wave), static_cast<std::uint8_t>(0.8 * wave),
                              static_cast<std::uint8_t>(200.0 - wave)};
        }
    return image;
}

const Mask kAll(kSize, kSize, 1);

TEST(Psnr, OfEqualImagesIsItsLimitAndOfAConstantDifferenceTheFormula)
{
    const ColorImage a = pattern();
    ColorImage b = a;
    for (Rgb8& p : b.pixels)
        for (auto& c : p)
            c = static_cast<std::uint8_t>(c + 5);
    EXPECT_EQ(psnr(a, a, kAll), 99.0);
    EXPECT_NEAR(psnr(a, b, kAll), 20.0 * std::log10(255.0 / 5.0), 1e-9);
    EXPECT_TRUE(std::isnan(psnr(a, b, Mask(kSize, kSize))));
}

TEST(Psnr, LooksAtTheMaskOnly)
{
    const ColorImage a = pattern();
    ColorImage b = a;
    Mask mask = kAll;
    b.at(3, 3) = {0, 255, 0};
    mask.at(3, 3) = 0;
    EXPECT_EQ(psnr(a, b, mask), 99.0);
}

TEST(Ssim, IsOneForEqualImagesAndFallsWithNoise)
{
    const ColorImage a = pattern();
    ColorImage b = a;
    for (std::size_t i = 0; i < b.pixels.size(); ++i)
        for (auto& c : b.pixels[i])
            c = static_cast<std::uint8_t>(c + (i * 2654435761u >> 13) % 30);
    EXPECT_NEAR(ssim(a, a, kAll), 1.0, 1e-5);
    EXPECT_LT(ssim(a, b, kAll), 0.95);
}

TEST(Ssim, OfFlatImagesComparesTheirMeans)
{
    // Without variance only the first factor is left: (2 a b + C1) / (a^2 + b^2 + C1).
    const ColorImage a(kSize, kSize, {100, 100, 100}), b(kSize, kSize, {150, 150, 150});
    const double x = 100 / 255.0, y = 150 / 255.0, c = 1e-4;
    EXPECT_NEAR(ssim(a, b, kAll), (2 * x * y + c) / (x * x + y * y + c), 1e-3);
}

TEST(FitAffineColor, UndoesGainAndBias)
{
    const ColorImage photo = pattern();
    ColorImage render = photo;
    for (Rgb8& p : render.pixels)
        p = {static_cast<std::uint8_t>(p[0] / 2 + 20), p[1], static_cast<std::uint8_t>(p[2] / 2)};
    const AffineColor fit = fit_affine_color(render, photo, kAll);
    EXPECT_NEAR(fit.gain[0], 2.0, 0.05);
    EXPECT_NEAR(fit.gain[1], 1.0, 1e-9);
    EXPECT_GT(psnr(apply_color(fit, render), photo, kAll), 45.0);
}

TEST(FitAffineColor, OfAFlatImageShiftsIt)
{
    const ColorImage flat(kSize, kSize, {50, 60, 70}), photo(kSize, kSize, {80, 80, 80});
    EXPECT_EQ(psnr(apply_color(fit_affine_color(flat, photo, kAll), flat), photo, kAll), 99.0);
}

TEST(GradientRatio, IsOneForEqualAndBelowForABlurredImage)
{
    const ColorImage a = pattern();
    ColorImage b = a;
    for (int y = 1; y + 1 < kSize; ++y)
        for (int x = 1; x + 1 < kSize; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                b.at(x, y)[c] = static_cast<std::uint8_t>(
                    (a.at(x - 1, y)[c] + a.at(x + 1, y)[c] + a.at(x, y - 1)[c] + a.at(x, y + 1)[c]) / 4);
    EXPECT_NEAR(gradient_ratio(a, a, kAll), 1.0, 1e-9);
    EXPECT_LT(gradient_ratio(b, a, kAll), 0.95);
}

} // namespace
} // namespace quoin
