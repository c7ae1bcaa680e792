#include "scan/undistortion.h"

#include "image/sampling.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

// Calls write(x, y, recorded pixel) for every pixel of the pinhole image.
template <class Write>
void for_each_pixel(const Camera& camera, const Write& write)
{
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x)
            write(x, y, distorted_pixel(camera, {x, y}));
}

Rgb8 rounded(const Eigen::Vector3f& color)
{
    const auto channel = [](float value) { return static_cast<std::uint8_t>(value + 0.5f); };
    return {channel(color.x()), channel(color.y()), channel(color.z())};
}

} // namespace

Eigen::Vector2d distorted_pixel(const Camera& camera, const Eigen::Vector2d& pixel)
{
    const double x = (pixel.x() - camera.cx) / camera.fx, y = (pixel.y() - camera.cy) / camera.fy;
    const double r2 = x * x + y * y;
    const double stretch = 1.0 + r2 * (camera.k1 + r2 * camera.k2);
    return {camera.fx * x * stretch + camera.cx, camera.fy * y * stretch + camera.cy};
}

ColorImage undistort(const ColorImage& image, const Camera& camera)
{
    const double right = std::nextafter(image.width - 1.0, 0.0), bottom = std::nextafter(image.height - 1.0, 0.0);
    ColorImage result(image.width, image.height);
    for_each_pixel(camera, [&](int x, int y, const Eigen::Vector2d& source) {
        result.at(x, y) =
            rounded(sample_color(image, std::clamp(source.x(), 0.0, right), std::clamp(source.y(), 0.0, bottom)));
    });
    return result;
}

Image<std::uint16_t> undistort(const Image<std::uint16_t>& depth, const Camera& camera)
{
    Image<std::uint16_t> result(depth.width, depth.height);
    for_each_pixel(camera, [&](int x, int y, const Eigen::Vector2d& source) {
        const double u = std::floor(source.x() + 0.5), v = std::floor(source.y() + 0.5);
        const bool inside = u >= 0.0 && v >= 0.0 && u < depth.width && v < depth.height;
        if (inside) result.at(x, y) = depth.at(static_cast<int>(u), static_cast<int>(v));
    });
    return result;
}

} // namespace quoin
