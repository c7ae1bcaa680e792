// A scan of painted planes, rendered exactly: every pixel has the colour of the world point at its centre.
#pragma once

#include "image/image_io.h"
#include "mesh/plane_mesh.h"
#include "render/rasterize.h"
#include "scan/alignment.h"
#include "scan/digest.h"
#include "scan/keyframes.h"
#include "scan/scan.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

namespace quoin::test {

using Paint = std::function<Eigen::Vector3d(const Eigen::Vector3d& p_world)>; // 0..255

inline Rigid looking_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                        const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ())
{
    const Eigen::Vector3d z = (target - eye).normalized(), x = z.cross(up).normalized(), y = z.cross(x);
    Rigid world_from_camera = Rigid::Identity();
    world_from_camera.linear() << x, y, z;
    world_from_camera.translation() = eye;
    return world_from_camera.inverse();
}

class PaintedScan {
public:
    // Colour images have 1/2^level of the size of depth.
    PaintedScan(PlaneMesh planes, Paint paint, int color_level = 0)
        : planes_(std::move(planes)), paint_(std::move(paint))
    {
        scan_.depth = {320, 240, 300.0, 300.0, 159.5, 119.5};
        scan_.color = scan_.depth.at_level(color_level);
        scan_.depth_unit = 0.0002;
        alignment_.color = scan_.color;
        alignment_.plane = planes_.plane;
    }

    // A keyframe whose recorded colours are (paint - bias) / gain.
    void add_view(const Rigid& camera_from_world, double gain = 1.0, double bias = 0.0)
    {
        add_view(camera_from_world, photograph(camera_from_world, gain, bias), depth_from(camera_from_world), gain,
                 bias);
    }

    // One whose depth image another pose saw.
    void add_view_with_depth_of(const Rigid& other_from_world, const Rigid& camera_from_world)
    {
        add_view(camera_from_world, photograph(camera_from_world, 1.0, 0.0), depth_from(other_from_world), 1.0, 0.0);
    }

    // A frame that is no keyframe, for views to be measured by.
    void hold_out(const Rigid& camera_from_world)
    {
        add_frame(camera_from_world, photograph(camera_from_world, 1.0, 0.0), depth_from(camera_from_world));
        scan_.frames.back().use = FrameUse::HeldOut;
    }

    ScanImages images() const { return {scan_, folder_.path()}; }
    const PlaneMesh& planes() const { return planes_; }
    const Keyframes& keyframes() const { return keyframes_; }
    const Alignment& alignment() const { return alignment_; }
    Eigen::Vector3d paint(const Eigen::Vector3d& p_world) const { return paint_(p_world); }

private:
    ColorImage photograph(const Rigid& camera_from_world, double gain, double bias) const
    {
        const Visibility seen = rasterize(planes_.mesh, scan_.color, camera_from_world);
        ColorImage color(scan_.color.width, scan_.color.height, Rgb8{0, 0, 0});
        for (int y = 0; y < color.height; ++y)
            for (int x = 0; x < color.width; ++x) {
                const double z = seen.depth.at(x, y);
                if (z <= 0.0) continue;
                const Eigen::Vector3d p_world = camera_from_world.inverse() * (scan_.color.ray({x, y}) * z);
                const Eigen::Vector3d recorded = (paint_(p_world).array() - bias) / gain;
                for (int c = 0; c < 3; ++c)
                    color.at(x, y)[static_cast<std::size_t>(c)] =
                        static_cast<std::uint8_t>(std::lround(std::clamp(recorded[c], 0.0, 255.0)));
            }
        return color;
    }

    Image<std::uint16_t> depth_from(const Rigid& camera_from_world) const
    {
        const Visibility seen = rasterize(planes_.mesh, scan_.depth, camera_from_world);
        Image<std::uint16_t> depth(scan_.depth.width, scan_.depth.height, 0);
        std::ranges::transform(seen.depth.pixels, depth.pixels.begin(),
                               [&](float z) { return static_cast<std::uint16_t>(std::lround(z / scan_.depth_unit)); });
        return depth;
    }

    void add_view(const Rigid& camera_from_world, const ColorImage& color, const Image<std::uint16_t>& depth,
                  double gain, double bias)
    {
        const FrameId id = add_frame(camera_from_world, color, depth);
        keyframes_.frame.push_back(id);
        keyframes_.blur.push_back(0.2f);
        keyframes_.reason.push_back(Dropped::Kept);
        alignment_.camera_from_world.push_back(camera_from_world);
        alignment_.gain.push_back(Eigen::Vector3f::Constant(static_cast<float>(gain)));
        alignment_.bias.push_back(Eigen::Vector3f::Constant(static_cast<float>(bias)));
    }

    FrameId add_frame(const Rigid& camera_from_world, const ColorImage& color, const Image<std::uint16_t>& depth)
    {
        const auto id = static_cast<FrameId>(scan_.frames.size());
        Frame frame;
        frame.camera_from_world = camera_from_world;
        frame.color = save("color" + std::to_string(id) + ".png", encode_png(color));
        frame.depth = save("depth" + std::to_string(id) + ".png", encode_png(depth));
        scan_.frames.push_back(frame);
        return id;
    }

    ScanFile save(const std::string& name, const std::vector<std::byte>& bytes)
    {
        std::ofstream(folder_ / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return {name, sha256(bytes)};
    }

    TemporaryFolder folder_;
    PlaneMesh planes_;
    Paint paint_;
    Scan scan_;
    Keyframes keyframes_;
    Alignment alignment_;
};

} // namespace quoin::test
