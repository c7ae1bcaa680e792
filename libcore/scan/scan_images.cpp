#include "base/error.h"
#include "image/image_io.h"
#include "image/sampling.h"
#include "scan/digest.h"
#include "scan/scan.h"
#include "scan/undistortion.h"

#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr std::uint16_t kNoReturn = 65535; // how Kinect recordings mark a missing depth, beside 0

const Frame& frame_of(const Scan& scan, FrameId id)
{
    if (id < scan.frames.size()) return scan.frames[id];
    throw InputError(
        fmt::format("frame {} is asked for, but the scan has {} frames; the artifacts belong to different scans", id,
                    scan.frames.size()));
}

const ScanFile& color_file(const Scan& scan, FrameId id)
{
    const ScanFile& file = frame_of(scan, id).color;
    if (file.name.empty()) throw InputError(fmt::format("frame {} of the scan has no colour image", id));
    return file;
}

std::vector<std::byte> read_checked(const fs::path& path, const ScanFile& file)
{
    std::vector<std::byte> bytes = read_bytes(path);
    if (sha256(bytes) != file.sha256)
        throw InputError(path.string() +
                         ": the file is not the one that was imported (its SHA-256 differs); restore it, " +
                         "give the right --scan-root, or import the scan again");
    return bytes;
}

template <class Pixel>
void check_size(const Image<Pixel>& image, const Camera& camera, const fs::path& path)
{
    if (image.width == camera.width && image.height == camera.height) return;
    throw InputError(fmt::format("{}: the image has {}x{} pixels; the camera of the scan has {}x{}", path.string(),
                                 image.width, image.height, camera.width, camera.height));
}

bool is_distorted(const Camera& camera) { return camera.k1 != 0.0 || camera.k2 != 0.0; }

DepthImage in_metres(const Image<std::uint16_t>& raw, double unit, double max_depth)
{
    DepthImage depth(raw.width, raw.height);
    for (std::size_t i = 0; i < raw.pixels.size(); ++i) {
        const double z = unit * raw.pixels[i];
        const bool missing = raw.pixels[i] == kNoReturn || (max_depth > 0.0 && z > max_depth);
        depth.pixels[i] = missing ? 0.0f : static_cast<float>(z);
    }
    return depth;
}

} // namespace

ScanImages::ScanImages(const Scan& scan, fs::path root) : scan_(&scan), root_(std::move(root))
{
    if (!fs::is_directory(root_))
        throw InputError(root_.string() +
                         ": the scan root is not a folder; give the folder that was imported by --scan-root");
}

ColorImage ScanImages::color(FrameId id) const
{
    const ScanFile& file = color_file(*scan_, id);
    const fs::path path = root_ / file.name;
    ColorImage image = decode_color(read_checked(path, file), path.string());
    check_size(image, scan_->color, path);
    return is_distorted(scan_->color) ? undistort(image, scan_->color) : image;
}

std::vector<std::byte> ScanImages::bytes(const ScanFile& file) const { return read_checked(root_ / file.name, file); }

GrayImage ScanImages::gray(FrameId id) const { return to_gray(color(id)); }

GrayImage ScanImages::recorded_gray(FrameId id, int reduction) const
{
    const ScanFile& file = color_file(*scan_, id);
    const fs::path path = root_ / file.name;
    return decode_gray(read_checked(path, file), path.string(), reduction);
}

DepthImage ScanImages::depth(FrameId id) const
{
    const ScanFile& file = frame_of(*scan_, id).depth;
    if (file.name.empty()) return {};
    const fs::path path = root_ / file.name;
    Image<std::uint16_t> raw = decode_gray16(read_checked(path, file), path.string());
    check_size(raw, scan_->depth, path);
    if (is_distorted(scan_->depth)) raw = undistort(raw, scan_->depth);
    return in_metres(raw, scan_->depth_unit, scan_->max_depth);
}

} // namespace quoin
