// A room of six textured planes, drawn analytically: what a colour and a depth camera see of it is exact.
#pragma once

#include "alignment/optimize_texture.h"
#include "geometry/moments.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace quoin::testing {

inline const Eigen::Vector3d kRoomSize(3.0, 2.4, 3.6); // [m]; corners at 0 and kRoomSize

// Smooth pseudo-random pattern of a wall, 0..1: value noise of several scales.
inline double pattern(int wall, double u, double v, double scale)
{
    const auto hash = [&](int x, int y) {
        auto h = static_cast<std::uint32_t>(x) * 0x9E3779B1u ^ static_cast<std::uint32_t>(y) * 0x85EBCA77u ^
                 static_cast<std::uint32_t>(wall + 1) * 0xC2B2AE3Du;
        h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
        h = (h ^ (h >> 12)) * 0x297A2D39u;
        return static_cast<double>((h ^ (h >> 15)) & 0xffffu) / 65535.0;
    };
    u /= scale;
    v /= scale;
    const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
    const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double a = ease(u - x), b = ease(v - y);
    return (1 - b) * ((1 - a) * hash(x, y) + a * hash(x + 1, y)) +
           b * ((1 - a) * hash(x, y + 1) + a * hash(x + 1, y + 1));
}

inline double wall_gray(int wall, double u, double v)
{
    return 0.15 + 0.7 * (0.5 * pattern(wall, u, v, 0.31) + 0.3 * pattern(wall + 10, u, v, 0.12) +
                         0.2 * pattern(wall + 20, u, v, 0.055));
}

struct RoomOptions {
    int frames = 8;
    double position_noise = 0.01;                         // [m], size of the error of every camera
    double rotation_noise = 0.5 * std::numbers::pi / 180; // [rad]
    double gain_noise = 0.0;
    double vignetting = 0.0;  // part of the light lost in the corners of the image
    double plane_error = 0.0; // [m], of the offsets of the input planes, to the inside and the outside in turn
    bool textured = true;
    bool saturated = false;
    bool with_depth = true;
    unsigned seed = 1;
    Rigid color_from_depth = Rigid::Identity();
};

struct TexturedRoom {
    Scan scan; // with the disturbed poses
    Keyframes keyframes;
    PlaneMesh mesh;
    std::vector<Rigid> true_camera_from_world;
    std::vector<Plane> true_plane;
    std::vector<double> true_gain;
    std::vector<ColorImage> color;
    std::vector<DepthImage> depth;

    ImageReader reader() const
    {
        return {[this](FrameId id) { return color[id]; }, [this](FrameId id) { return depth[id]; }};
    }
};

// Wall w = 2 axis + side has the inward normal -+ axis.
inline Plane room_plane(int wall)
{
    const int axis = wall / 2;
    const bool far_side = wall % 2 == 1;
    Plane plane{far_side ? Eigen::Vector3d(-Eigen::Vector3d::Unit(axis)) : Eigen::Vector3d(Eigen::Vector3d::Unit(axis)),
                0.0};
    plane.offset = far_side ? kRoomSize[axis] : 0.0;
    return plane;
}

inline PlaneMesh room_mesh(const RoomOptions& options)
{
    PlaneMesh mesh;
    for (int wall = 0; wall < 6; ++wall) {
        const int axis = wall / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
        const Plane plane = room_plane(wall);
        const double error = wall % 4 < 2 ? options.plane_error : -options.plane_error;
        std::array<Eigen::Vector3d, 4> p;
        for (std::size_t i = 0; i < 4; ++i) {
            p[i] = Eigen::Vector3d::Zero();
            p[i][axis] = (wall % 2 == 1 ? kRoomSize[axis] : 0.0);
            p[i][a] = i == 1 || i == 2 ? kRoomSize[a] : 0.0;
            p[i][b] = i >= 2 ? kRoomSize[b] : 0.0;
            p[i] += error * plane.normal;
        }
        const auto first = static_cast<VertexId>(mesh.mesh.position.size());
        for (const auto& corner : p)
            mesh.mesh.position.push_back(corner.cast<float>());
        const bool flip = wall % 2 == 1;
        for (Face f : {Face{0, 1, 2}, Face{0, 2, 3}}) {
            if (flip) std::swap(f[1], f[2]);
            mesh.mesh.face.push_back({first + f[0], first + f[1], first + f[2]});
            mesh.face_plane.push_back(static_cast<PlaneId>(wall));
        }
        mesh.moments.push_back(triangle_moments(p[0], p[1], p[2]) + triangle_moments(p[0], p[2], p[3]));
        mesh.plane.push_back({plane.normal, plane.offset - error});
    }
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    return mesh;
}

// Wall and distance along a ray from a point inside the room.
inline std::pair<int, double> hit_wall(const Eigen::Vector3d& from, const Eigen::Vector3d& direction)
{
    std::pair<int, double> nearest{-1, 1e9};
    for (int wall = 0; wall < 6; ++wall) {
        const Plane plane = room_plane(wall);
        const double speed = plane.normal.dot(direction);
        if (speed >= 0.0) continue;
        const double t = -plane.signed_distance(from) / speed;
        if (t < nearest.second) nearest = {wall, t};
    }
    return nearest;
}

inline double seen_gray(const RoomOptions& options, const Eigen::Vector3d& from, const Eigen::Vector3d& direction)
{
    if (options.saturated) return 1.0;
    if (!options.textured) return 0.7;
    const auto [wall, t] = hit_wall(from, direction);
    const Eigen::Vector3d p = from + t * direction;
    return wall_gray(wall, p[(wall / 2 + 1) % 3], p[(wall / 2 + 2) % 3]);
}

// Mean of 3x3 rays in each pixel.
inline ColorImage draw_color(const RoomOptions& options, const Camera& camera, const Rigid& camera_from_world,
                             double gain)
{
    ColorImage image(camera.width, camera.height);
    const Rigid world_from_camera = camera_from_world.inverse();
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            double sum = 0.0;
            for (int i = 0; i < 9; ++i) {
                const Eigen::Vector2d pixel(x + (i % 3 - 1) / 3.0, y + (i / 3 - 1) / 3.0);
                sum += seen_gray(options, world_from_camera.translation(),
                                 world_from_camera.linear() * camera.ray(pixel)) /
                       9.0;
            }
            const double light =
                1.0 - options.vignetting * Vignetting::squared_radius(camera.width, camera.height, {x, y});
            const auto value = static_cast<std::uint8_t>(std::clamp(std::lround(255.0 * light * gain * sum), 0L, 255L));
            image.at(x, y) = {value, value, value};
        }
    return image;
}

inline DepthImage draw_depth(const Camera& camera, const Rigid& camera_from_world)
{
    DepthImage depth(camera.width, camera.height);
    const Rigid world_from_camera = camera_from_world.inverse();
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x)
            depth.at(x, y) = static_cast<float>(
                hit_wall(world_from_camera.translation(), world_from_camera.linear() * camera.ray({x, y})).second);
    return depth;
}

// Cameras on a small arc in the middle of the room that look into one of its corners, each held at another angle.
inline Rigid room_camera(int k, int frames)
{
    const double s = frames > 1 ? static_cast<double>(k) / (frames - 1) - 0.5 : 0.0;
    const Eigen::Vector3d eye(1.9 + 0.5 * s, 1.2 + 0.25 * std::sin(5.0 * s), 2.4 - 0.5 * s);
    const Eigen::Vector3d target(0.1 + 0.8 * s, 1.5 + 0.5 * std::cos(9.0 * s), 0.2 - 0.4 * s);
    const Eigen::Vector3d z = (target - eye).normalized();
    const Eigen::Vector3d x = Eigen::Vector3d(0, 1, 0).cross(z).normalized(); // +y is down
    Rigid world_from_camera = Rigid::Identity();
    world_from_camera.linear() << x, z.cross(x), z;
    world_from_camera.rotate(Eigen::AngleAxisd(0.6 * std::sin(2.3 * k), Eigen::Vector3d::UnitZ()));
    world_from_camera.translation() = eye;
    return world_from_camera.inverse();
}

inline TexturedRoom textured_room(const RoomOptions& options)
{
    TexturedRoom room;
    std::mt19937 random(options.seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto direction = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized(); };
    room.scan.color = room.scan.depth = {.width = 160, .height = 120, .fx = 130.0, .fy = 130.0, .cx = 79.5, .cy = 59.5};
    room.scan.depth_from_color = options.color_from_depth.inverse();
    room.mesh = room_mesh(options);
    for (int wall = 0; wall < 6; ++wall)
        room.true_plane.push_back(room_plane(wall));
    for (int k = 0; k < options.frames; ++k) {
        const Rigid truth = room_camera(k, options.frames);
        Rigid noise = Rigid::Identity();
        noise.linear() = Eigen::AngleAxisd(options.rotation_noise, direction()).toRotationMatrix();
        Rigid world_from_camera = truth.inverse() * noise;
        world_from_camera.translation() += options.position_noise * direction();
        Frame frame;
        frame.camera_from_world = world_from_camera.inverse();
        room.scan.frames.push_back(frame);
        room.true_camera_from_world.push_back(truth);
        room.true_gain.push_back(1.0 + options.gain_noise * uniform(random));
        room.color.push_back(
            draw_color(options, room.scan.color, options.color_from_depth * truth, room.true_gain.back()));
        room.depth.push_back(options.with_depth ? draw_depth(room.scan.depth, truth) : DepthImage());
        room.keyframes.frame.push_back(static_cast<FrameId>(k));
    }
    return room;
}

// Root mean square distance of camera centres [m], without any alignment: the room fixes the frame.
inline double position_error(const std::vector<Rigid>& camera_from_world, const std::vector<Rigid>& truth)
{
    double sum = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k)
        sum += (camera_from_world[k].inverse().translation() - truth[k].inverse().translation()).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
}

} // namespace quoin::testing
