#include "report/draw.h"

#include "image/sampling.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

void mix(Rgb8& pixel, const Rgb8& color, double part)
{
    for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(std::lround((1.0 - part) * pixel[c] + part * color[c]));
}

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
    const Eigen::Vector2d ab = b - a;
    const double square = ab.squaredNorm();
    const double t = square > 0.0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
    return (p - a - t * ab).norm();
}

} // namespace

void draw_line(ColorImage& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Rgb8& color,
               double width)
{
    if (!from.allFinite() || !to.allFinite()) return;
    const Eigen::Array2d low = from.array().min(to.array()) - width, high = from.array().max(to.array()) + width;
    const auto pixel = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, size - 1.0)); };
    for (int y = pixel(low.y(), image.height); y <= pixel(high.y(), image.height); ++y)
        for (int x = pixel(low.x(), image.width); x <= pixel(high.x(), image.width); ++x) {
            const double outside = distance_to_segment({x, y}, from, to) - width / 2.0;
            mix(image.at(x, y), color, std::clamp(0.5 - outside, 0.0, 1.0));
        }
}

ColorImage resized(ColorImage image, int width, int height)
{
    while (image.width >= 2 * width && image.height >= 2 * height)
        image = half_size(image);
    if (image.width == width && image.height == height) return image;
    ColorImage result(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = std::clamp((x + 0.5) * image.width / width - 0.5, 0.0, image.width - 1.001),
                         v = std::clamp((y + 0.5) * image.height / height - 0.5, 0.0, image.height - 1.001);
            const Eigen::Vector3f color = sample_color(image, u, v);
            for (int c = 0; c < 3; ++c)
                result.at(x, y)[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(color[c]));
        }
    return result;
}

ColorImage side_by_side(const std::vector<ColorImage>& images, int columns)
{
    if (images.empty()) return {};
    columns = std::min(columns, static_cast<int>(images.size()));
    const int rows = (static_cast<int>(images.size()) + columns - 1) / columns;
    const int width = images[0].width, height = images[0].height;
    ColorImage sheet(columns * width, rows * height, kPaper);
    for (std::size_t i = 0; i < images.size(); ++i) {
        const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
        for (int y = 0; y < height; ++y)
            std::copy_n(images[i].row(y), width, sheet.row(row * height + y) + column * width);
    }
    return sheet;
}

} // namespace quoin
