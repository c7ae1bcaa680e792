// Sampling between pixel centres, and conversions that every stage shares.
#pragma once

#include "image/image.h"

#include <Eigen/Core>
#include <cmath>

namespace quoin {

GrayImage to_gray(const ColorImage& color); // Rec. 601 luma, 0..1

// Halves the size by averaging 2x2 pixels; pixel (x, y) covers pixels 2x..2x+1, 2y..2y+1 (Camera::at_level).
GrayImage half_size(const GrayImage& image);
ColorImage half_size(const ColorImage& image);
// Depth is never averaged across jumps: the nearest valid of the four.
DepthImage half_depth(const DepthImage& depth);

// Separable Gaussian, borders repeated. sigma [px].
GrayImage smooth(const GrayImage& image, double sigma);

struct GraySample {
    float value;
    float gx, gy; // exact derivative of the bilinear surface [1/px]
};

// Bilinear sample; x in [0, width-1), y in [0, height-1).
inline GraySample sample_gray(const GrayImage& image, double x, double y)
{
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const float* top = image.row(y0) + x0;
    const float* bottom = image.row(y0 + 1) + x0;
    const float dx_top = top[1] - top[0], dx_bottom = bottom[1] - bottom[0];
    const float value_top = top[0] + fx * dx_top, value_bottom = bottom[0] + fx * dx_bottom;
    return {value_top + fy * (value_bottom - value_top), dx_top + fy * (dx_bottom - dx_top), value_bottom - value_top};
}

// Bilinear colour, 0..255; x in [0, width-1), y in [0, height-1).
inline Eigen::Vector3f sample_color(const ColorImage& image, double x, double y)
{
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const auto pixel = [](const Rgb8& p) { return Eigen::Vector3f(p[0], p[1], p[2]); };
    const Rgb8* top = image.row(y0) + x0;
    const Rgb8* bottom = image.row(y0 + 1) + x0;
    return (1 - fy) * ((1 - fx) * pixel(top[0]) + fx * pixel(top[1])) +
           fy * ((1 - fx) * pixel(bottom[0]) + fx * pixel(bottom[1]));
}

// Colour by cubic convolution (Keys 1981), which goes through the pixels; beyond 0..255 where it swings over. Somewhat
// sharper than Keys's own kernel, for what it gives is sampled bilinearly once more. Pixels outside the image are those
// of its border.
Eigen::Vector3f sample_color_cubic(const ColorImage& image, double x, double y);

} // namespace quoin
