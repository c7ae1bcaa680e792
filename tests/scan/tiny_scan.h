// Tiny scans in every layout: a camera inside a box-shaped room, written to a temporary folder.
#pragma once

#include "base/atomic_file.h"
#include "image/image_io.h"
#include "scan/scan.h"
#include "support/temporary_folder.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace quoin::test {

inline const Camera kTinyCamera{64, 48, 50.0, 50.0, 31.5, 23.5};

// Poses of a camera that walks and turns through the room, camera to world.
inline std::vector<Eigen::Matrix4d> walk(int frames)
{
    std::vector<Eigen::Matrix4d> poses;
    for (int i = 0; i < frames; ++i) {
        Rigid world_from_camera = Rigid::Identity();
        world_from_camera.linear() = (Eigen::AngleAxisd(0.10 * i - 0.4, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(0.05 * i + 0.1, Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix();
        world_from_camera.translation() << 0.06 * i + 0.2, 0.03 * i - 0.3, 0.05 * i + 0.1;
        poses.push_back(world_from_camera.matrix());
    }
    return poses;
}

// Distance along z at which the ray through each pixel leaves the room x in [-1.5, 2], y in [-1, 1.2], z in [-2, 3]
// [m].
inline DepthImage room_depth(const Eigen::Matrix4d& world_from_camera, const Camera& camera = kTinyCamera)
{
    const Eigen::Vector3d low(-1.5, -1.0, -2.0), high(2.0, 1.2, 3.0);
    const Eigen::Vector3d origin = world_from_camera.topRightCorner<3, 1>();
    DepthImage depth(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const Eigen::Vector3d ray = world_from_camera.topLeftCorner<3, 3>() * camera.ray({x, y});
            double z = 1e9;
            for (int k = 0; k < 3; ++k)
                if (ray[k] != 0.0) z = std::min(z, ((ray[k] > 0.0 ? high : low)[k] - origin[k]) / ray[k]);
            depth.at(x, y) = static_cast<float>(z);
        }
    return depth;
}

inline Image<std::uint16_t> in_steps(const DepthImage& depth, double unit)
{
    Image<std::uint16_t> steps(depth.width, depth.height);
    for (std::size_t i = 0; i < depth.pixels.size(); ++i)
        steps.pixels[i] = static_cast<std::uint16_t>(depth.pixels[i] / unit + 0.5);
    return steps;
}

inline ColorImage checkers(int width, int height)
{
    ColorImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = (x / 4 + y / 4) % 2 ? Rgb8{200, 180, 160} : Rgb8{40, 60, 80};
    return image;
}

inline std::string matrix_text(const Eigen::Matrix4d& m)
{
    std::string text;
    for (int row = 0; row < 4; ++row)
        text += fmt::format("{} {} {} {}\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
    return text;
}

inline std::string tum_line(const std::string& time, const Eigen::Matrix4d& m)
{
    const Eigen::Quaterniond q(Eigen::Matrix3d(m.topLeftCorner<3, 3>()));
    return fmt::format("{} {} {} {} {} {} {} {}\n", time, m(0, 3), m(1, 3), m(2, 3), q.x(), q.y(), q.z(), q.w());
}

// A folder to fill with files of a layout.
class ScanFolder {
public:
    const std::filesystem::path& path() const { return folder_.path(); }
    void write(const std::string& name, const std::string& text) const
    {
        write_bytes(name, std::as_bytes(std::span(text)));
    }
    void write_bytes(const std::string& name, std::span<const std::byte> bytes) const
    {
        std::filesystem::create_directories((path() / name).parent_path());
        write_atomically(path() / name, bytes);
    }
    void write_color(const std::string& name, int width = 64, int height = 48) const
    {
        const ColorImage image = checkers(width, height);
        write_bytes(name, name.ends_with(".png") ? encode_png(image) : encode_jpeg(image, 90));
    }
    void write_depth(const std::string& name, const Eigen::Matrix4d& pose, double unit,
                     const Camera& camera = kTinyCamera) const
    {
        write_bytes(name, encode_png(in_steps(room_depth(pose, camera), unit)));
    }

private:
    TemporaryFolder folder_;
};

inline std::string frame_name(std::size_t i, const char* ending) { return fmt::format("frame-{:06}.{}", i, ending); }

// A scan in the 7-Scenes layout; its intrinsics are those of the tiny camera.
inline void write_seven_scenes(const ScanFolder& folder, const std::vector<Eigen::Matrix4d>& poses)
{
    folder.write("camera-intrinsics.txt", "50 0 31.5\n0 50 23.5\n0 0 1\n");
    for (std::size_t i = 0; i < poses.size(); ++i) {
        folder.write_color(frame_name(i, "color.jpg"));
        folder.write_depth(frame_name(i, "depth.png"), poses[i], 0.001);
        folder.write(frame_name(i, "pose.txt"), matrix_text(poses[i]));
    }
}

} // namespace quoin::test
