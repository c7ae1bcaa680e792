#pragma once

#include <Eigen/Core>

namespace quoin {

// Light that a lens loses towards the corners of the image, the same in all frames: without the loss a colour is
// correction() * observed.
struct Vignetting {
    Eigen::Vector3f k = Eigen::Vector3f::Zero(); // of r^2, r^4 and r^6

    // r is the distance to the middle of the image over that of its corners.
    double correction(double squared_radius) const
    {
        return 1.0 + squared_radius * (k[0] + squared_radius * (k[1] + squared_radius * k[2]));
    }
    static double squared_radius(int width, int height, const Eigen::Vector2d& pixel)
    {
        const Eigen::Vector2d corner(0.5 * (width - 1), 0.5 * (height - 1));
        return (pixel - corner).squaredNorm() / corner.squaredNorm();
    }
};

} // namespace quoin
