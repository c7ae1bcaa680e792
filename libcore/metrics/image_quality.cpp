#include "metrics/image_quality.h"

#include "image/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace quoin {
namespace {

constexpr double kMostDecibels = 99.0;
constexpr int kWindow = 11;
constexpr double kWindowSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03; // of a range of 1 (Wang et al. 2004, section III.C)

cv::Mat as_mat(GrayImage& image) { return {image.height, image.width, CV_32F, image.pixels.data()}; }

cv::Mat window_mean(const cv::Mat& image)
{
    cv::Mat mean;
    cv::GaussianBlur(image, mean, {kWindow, kWindow}, kWindowSigma, kWindowSigma, cv::BORDER_REFLECT_101);
    return mean;
}

} // namespace

AffineColor fit_affine_color(const ColorImage& render, const ColorImage& photo, const Mask& mask)
{
    AffineColor fit;
    for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
            if (!mask.pixels[i]) continue;
            const double r = render.pixels[i][channel], p = photo.pixels[i][channel];
            n += 1, x += r, y += p, xx += r * r, xy += r * p;
        }
        const double determinant = n * xx - x * x;
        if (determinant > 1e-9 * n * xx) {
            fit.gain[c] = (n * xy - x * y) / determinant;
            fit.bias[c] = (y - fit.gain[c] * x) / n;
        } else if (n > 0) {
            fit.bias[c] = (y - x) / n;
        }
    }
    return fit;
}

ColorImage apply_color(const AffineColor& fit, const ColorImage& image)
{
    ColorImage result = image;
    for (Rgb8& pixel : result.pixels)
        for (int c = 0; c < 3; ++c) {
            auto& value = pixel[static_cast<std::size_t>(c)];
            value = static_cast<std::uint8_t>(std::clamp(fit.gain[c] * value + fit.bias[c] + 0.5, 0.0, 255.0));
        }
    return result;
}

double psnr(const ColorImage& render, const ColorImage& photo, const Mask& mask)
{
    double square = 0.0, count = 0.0;
    for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
        if (!mask.pixels[i]) continue;
        for (std::size_t c = 0; c < 3; ++c)
            square += std::pow(static_cast<double>(render.pixels[i][c]) - photo.pixels[i][c], 2);
        count += 3.0;
    }
    if (count == 0.0) return std::numeric_limits<double>::quiet_NaN();
    return square == 0.0 ? kMostDecibels : std::min(kMostDecibels, 10.0 * std::log10(255.0 * 255.0 * count / square));
}

double ssim(const ColorImage& render, const ColorImage& photo, const Mask& mask)
{
    ColorImage filled = photo;
    for (std::size_t i = 0; i < mask.pixels.size(); ++i)
        if (mask.pixels[i]) filled.pixels[i] = render.pixels[i];
    GrayImage gray_x = to_gray(filled), gray_y = to_gray(photo);
    const cv::Mat x = as_mat(gray_x), y = as_mat(gray_y);
    const cv::Mat mx = window_mean(x), my = window_mean(y);
    const cv::Mat xx = window_mean(x.mul(x)), yy = window_mean(y.mul(y)), xy = window_mean(x.mul(y));
    double sum = 0.0, count = 0.0;
    for (int v = 0; v < mask.height; ++v)
        for (int u = 0; u < mask.width; ++u) {
            if (!mask.at(u, v)) continue;
            const double a = mx.at<float>(v, u), b = my.at<float>(v, u);
            const double va = xx.at<float>(v, u) - a * a, vb = yy.at<float>(v, u) - b * b,
                         ab = xy.at<float>(v, u) - a * b;
            sum += (2 * a * b + kC1) * (2 * ab + kC2) / ((a * a + b * b + kC1) * (va + vb + kC2));
            count += 1.0;
        }
    return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

double gradient_ratio(const ColorImage& render, const ColorImage& photo, const Mask& mask)
{
    const GrayImage a = to_gray(render), b = to_gray(photo);
    const auto gradient = [](const GrayImage& g, int x, int y) {
        return std::hypot(g.at(x + 1, y) - g.at(x - 1, y), g.at(x, y + 1) - g.at(x, y - 1));
    };
    double of_render = 0.0, of_photo = 0.0;
    for (int y = 1; y + 1 < mask.height; ++y)
        for (int x = 1; x + 1 < mask.width; ++x) {
            if (!mask.at(x, y) || !mask.at(x - 1, y) || !mask.at(x + 1, y) || !mask.at(x, y - 1) || !mask.at(x, y + 1))
                continue;
            of_render += static_cast<double>(gradient(a, x, y));
            of_photo += static_cast<double>(gradient(b, x, y));
        }
    return of_photo > 0.0 ? of_render / of_photo : std::numeric_limits<double>::quiet_NaN();
}

} // namespace quoin
