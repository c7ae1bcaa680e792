#pragma once

#include "image/image.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

inline constexpr Rgb8 kPaper{255, 255, 255}; // under every picture

// A straight line `width` pixels wide, with soft edges.
void draw_line(ColorImage& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Rgb8& color,
               double width);

// The image at another size: means of 2x2 pixels down to the nearest power of two, then bilinear.
ColorImage resized(ColorImage image, int width, int height);

// Images of one size in rows of `columns`.
ColorImage side_by_side(const std::vector<ColorImage>& images, int columns);

} // namespace quoin
