#pragma once

#include <Eigen/Core>

namespace quoin {

// A pinhole camera: +x right, +y down, +z forward, pixel centres at integers. fx, fy > 0.
// k1, k2 are radial distortion of the *recorded* image (x_d = x (1 + k1 r^2 + k2 r^4), OpenCV's model); images are
// undistorted when they are read, so algorithms see a pure pinhole and project() and ray() ignore them.
struct Camera {
    int width = 0;                                 // [px]
    int height = 0;                                // [px]
    double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0; // [px]
    double k1 = 0.0, k2 = 0.0;

    // Pixel of a point in camera coordinates; p.z() must be positive.
    Eigen::Vector2d project(const Eigen::Vector3d& p) const
    {
        return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
    }
    // Point of unit depth on the ray through a pixel: ray(u) * z is the point of depth z.
    Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const
    {
        return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
    }
    // Is a pixel at least `border` px inside the image?
    bool contains(const Eigen::Vector2d& pixel, double border = 0.0) const
    {
        return pixel.x() >= border && pixel.y() >= border && pixel.x() <= width - 1 - border &&
               pixel.y() <= height - 1 - border;
    }
    // The camera of the image at 1/2^level of the size (pixel centres at integers: cx' = (cx + 0.5) / 2^l - 0.5).
    Camera at_level(int level) const
    {
        const double s = 1.0 / (1 << level);
        return {width >> level, height >> level, fx * s, fy * s, (cx + 0.5) * s - 0.5, (cy + 0.5) * s - 0.5, k1, k2};
    }
};

} // namespace quoin
