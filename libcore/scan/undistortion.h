// Images as a pure pinhole camera would have taken them.
#pragma once

#include "geometry/camera.h"
#include "image/image.h"

#include <cstdint>

namespace quoin {

// Pixel of the recorded (distorted) image where the pixel `pixel` of the pinhole image lies: x_d = x (1 + k1 r^2 + k2
// r^4).
Eigen::Vector2d distorted_pixel(const Camera& camera, const Eigen::Vector2d& pixel);

// Bilinear; what lies outside the recorded image repeats its border.
ColorImage undistort(const ColorImage& image, const Camera& camera);
// Nearest pixel, as depth is never averaged; what lies outside the recorded image is missing (0).
Image<std::uint16_t> undistort(const Image<std::uint16_t>& depth, const Camera& camera);

} // namespace quoin
