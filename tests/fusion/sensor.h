// Depth and colour images of shapes given by a formula, as a perfect sensor would take them.
#pragma once

#include "fusion/fuse.h"

#include <cmath>
#include <limits>
#include <vector>

namespace quoin::testing {

inline Camera small_camera() { return {160, 120, 140.0, 140.0, 79.5, 59.5}; }

// Looks from `eye` to `target`; the world's y points down.
inline Rigid look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target)
{
    const Eigen::Vector3d z = (target - eye).normalized();
    const Eigen::Vector3d down = std::abs(z.y()) > 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d x = down.cross(z).normalized();
    Eigen::Matrix3d world_from_camera;
    world_from_camera << x, z.cross(x), z;
    Rigid camera_from_world = Rigid::Identity();
    camera_from_world.linear() = world_from_camera.transpose();
    camera_from_world.translation() = -(world_from_camera.transpose() * eye);
    return camera_from_world;
}

// A shape: the smallest t > 0 at which eye + t * ray meets it (infinity if it does not), and its colour there.
struct Shape {
    std::function<double(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray)> hit;
    std::function<Rgb8(const Eigen::Vector3d& p_world)> color = [](const Eigen::Vector3d&) {
        return Rgb8{100, 150, 200};
    };
};

inline Shape plane_at_z(double z)
{
    return {[z](const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) {
        const double t = (z - eye.z()) / ray.z();
        return t > 0.0 ? t : std::numeric_limits<double>::infinity();
    }};
}

inline Shape sphere(const Eigen::Vector3d& center, double radius)
{
    return {[=](const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) {
        const Eigen::Vector3d d = eye - center;
        const double a = ray.squaredNorm(), b = d.dot(ray), c = d.squaredNorm() - radius * radius;
        const double root = b * b - a * c;
        const double t = root < 0.0 ? -1.0 : (-b - std::sqrt(root)) / a;
        return t > 0.0 ? t : std::numeric_limits<double>::infinity();
    }};
}

// The inside of a box.
inline Shape room(const Eigen::Vector3d& half_size)
{
    return {[=](const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) {
        double t = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k)
            if (ray[k] != 0.0) t = std::min(t, (std::copysign(half_size[k], ray[k]) - eye[k]) / ray[k]);
        return t;
    }};
}

inline Shape nearest_of(const Shape& a, const Shape& b)
{
    return {[=](const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) {
                return std::min(a.hit(eye, ray), b.hit(eye, ray));
            },
            a.color};
}

struct RenderedScan {
    Scan scan;
    Shape shape;

    void add(const Rigid& camera_from_world)
    {
        Frame frame;
        frame.camera_from_world = camera_from_world;
        frame.color.name = "color";
        frame.depth.name = "depth";
        scan.frames.push_back(frame);
    }
    // Image of pixel(t, point) seen by a camera.
    template <class Pixel, class Function>
    Image<Pixel> render(const Camera& camera, const Rigid& camera_from_world, const Function& pixel) const
    {
        const Rigid world_from_camera = camera_from_world.inverse();
        const Eigen::Vector3d eye = world_from_camera.translation();
        Image<Pixel> image(camera.width, camera.height);
        for (int y = 0; y < camera.height; ++y) {
            for (int x = 0; x < camera.width; ++x) {
                const Eigen::Vector3d ray = world_from_camera.linear() * camera.ray({x, y});
                const double t = shape.hit(eye, ray);
                if (std::isfinite(t)) image.at(x, y) = pixel(t, eye + t * ray);
            }
        }
        return image;
    }
    FrameSource source() const
    {
        const auto depth = [](double t, const Eigen::Vector3d&) { return static_cast<float>(t); };
        return {
            [this, depth](FrameId id) { return render<float>(scan.depth, scan.frames[id].camera_from_world, depth); },
            [this](FrameId id) {
                return render<Rgb8>(scan.color, scan.color_from_world(id),
                                    [&](double, const Eigen::Vector3d& p) { return shape.color(p); });
            }};
    }
};

inline RenderedScan scan_of(const Shape& shape)
{
    RenderedScan rendered{{}, shape};
    rendered.scan.color = rendered.scan.depth = small_camera();
    return rendered;
}

} // namespace quoin::testing
