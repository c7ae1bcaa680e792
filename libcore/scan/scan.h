// A scan: a table of frames with their poses and the cameras that took them. It names image files and never holds
// pixels; ScanImages reads them.
#pragma once

#include "geometry/camera.h"
#include "geometry/rigid.h"
#include "image/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

using FrameId = std::uint32_t; // index into Scan::frames
using Sha256 = std::array<std::uint8_t, 32>;

// HeldOut frames have a good pose but no stage may use them; evaluate renders their views.
enum class FrameUse : std::uint8_t { Invalid = 0, Used = 1, HeldOut = 2 };

struct ScanFile {
    std::string name; // relative to the scan root, '/' as separator; "" = none
    Sha256 sha256{};
};

struct Frame {
    Rigid camera_from_world = Rigid::Identity(); // of the depth camera
    FrameUse use = FrameUse::Used;
    double time = 0.0; // [s]
    ScanFile color;
    ScanFile depth; // a frame may lack one of the two

    bool has_color() const { return !color.name.empty(); }
    bool has_depth() const { return !depth.name.empty(); }
    const std::string& name() const { return has_color() ? color.name : depth.name; }
};

struct Scan {
    Camera color;
    Camera depth;
    Rigid depth_from_color = Rigid::Identity(); // maps points of the colour camera into the depth camera
    double depth_unit = 0.001;                  // metres a step of the depth files
    double max_depth = 0.0;                     // depths beyond are missing [m]; 0 = no limit
    std::vector<Frame> frames;
    ScanFile dense_mesh; // the scan folder's own mesh (PLY), if it has one

    Rigid color_from_world(FrameId id) const { return depth_from_color.inverse() * frames[id].camera_from_world; }
    std::vector<FrameId> frames_in_use() const; // FrameUse::Used, in order
    std::vector<FrameId> frames_held_out() const;
};

// Reads images of a scan from its root. Every file is checked against its SHA-256: InputError when it changed, is
// missing or is no image of the camera's size. Safe to call from several threads.
class ScanImages {
public:
    ScanImages(const Scan& scan, std::filesystem::path root);
    ColorImage color(FrameId id) const; // undistorted, size of scan.color
    GrayImage gray(FrameId id) const;   // luma of color()
    // As recorded, at 1/reduction (1, 2, 4) of the size: for measures that need no geometry.
    GrayImage recorded_gray(FrameId id, int reduction) const;
    // [m], 0 = missing (0 and 65535 in the file), size of scan.depth; empty if the frame has none.
    DepthImage depth(FrameId id) const;
    std::vector<std::byte> bytes(const ScanFile& file) const; // any other file of the scan, such as its dense mesh
    const Scan& scan() const { return *scan_; }

private:
    const Scan* scan_;
    std::filesystem::path root_;
};

} // namespace quoin
