#include "scan/import.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "image/image_io.h"
#include "scan/digest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace quoin {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& message)
{
    throw InputError(path.string() + ": " + message);
}

// Every n-th frame up to the largest number; frames of depth alone are counted on their own and add to them.
std::vector<ListedFrame> chosen_frames(std::vector<ListedFrame> frames, const ImportParams& params)
{
    const auto step = static_cast<std::size_t>(params.frame_step), most = static_cast<std::size_t>(params.max_frames);
    std::vector<ListedFrame> chosen;
    std::size_t with_color = 0, depth_alone = 0, taken = 0;
    for (ListedFrame& frame : frames) {
        const bool has_color = !frame.color.empty();
        std::size_t& count = has_color ? with_color : depth_alone;
        if (count++ % step != 0) continue;
        if (has_color && most > 0 && taken++ == most) break;
        chosen.push_back(std::move(frame));
    }
    return chosen;
}

Listing list_frames(const LayoutReader& reader, const fs::path& folder, const ImportParams& params)
{
    Listing listing = reader.read(folder, params.max_time_gap);
    if (listing.frames.empty() && listing.absent.count > 0)
        fail(folder, fmt::format("none of the {} files that its lists name is in the folder (for example {}); copy the "
                                 "images beside the lists",
                                 listing.absent.named, listing.absent.example));
    if (std::ranges::all_of(listing.frames, [](const ListedFrame& frame) { return frame.color.empty(); }))
        fail(folder, fmt::format("no colour image in the folder; the {} layout needs {}", reader.title, reader.needs));
    listing.frames = chosen_frames(std::move(listing.frames), params);
    return listing;
}

// What one look at a file tells.
struct ImageFile {
    Sha256 sha256{};
    ImageInfo info;
};

ImageFile look_at(const fs::path& path)
{
    const std::vector<std::byte> bytes = read_bytes(path);
    return {sha256(bytes), inspect_image(bytes, path.string())};
}

void check_color(const ImageFile& file, const fs::path& path)
{
    if (file.info.bits != 8)
        fail(path, fmt::format("the colour image has {} bits a channel; expected 8", file.info.bits));
}

void check_depth(const ImageFile& file, const fs::path& path)
{
    if (file.info.bits != 16 || file.info.channels != 1)
        fail(path, fmt::format("the depth image has {} channel(s) of {} bits; expected 1 of 16", file.info.channels,
                               file.info.bits));
}

struct LookedAtFrames {
    std::vector<ImageFile> color, depth; // default where there is none
};

LookedAtFrames look_at_all(const fs::path& folder, const std::vector<ListedFrame>& frames)
{
    LookedAtFrames files{std::vector<ImageFile>(frames.size()), std::vector<ImageFile>(frames.size())};
    Progress progress("reading files", frames.size());
    parallel_for(frames.size(), [&](std::size_t i) {
        if (!frames[i].color.empty()) {
            files.color[i] = look_at(folder / frames[i].color);
            check_color(files.color[i], folder / frames[i].color);
        }
        if (!frames[i].depth.empty()) {
            files.depth[i] = look_at(folder / frames[i].depth);
            check_depth(files.depth[i], folder / frames[i].depth);
        }
        progress.step();
    });
    return files;
}

struct Size {
    int width = 0, height = 0; // [px]; 0 = no image
    bool operator==(const Size&) const = default;
};

Size size_of(const ImageFile& file) { return {file.info.width, file.info.height}; }

// The one size that all images of a kind have.
template <class Name>
Size common_size(const std::vector<ImageFile>& files, const fs::path& folder, const Name& name)
{
    Size size;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (size_of(files[i]) == Size{}) continue;
        if (size == Size{}) size = size_of(files[i]);
        if (size_of(files[i]) != size)
            fail(folder / name(i),
                 fmt::format(
                     "the image has {}x{} pixels, those before it {}x{}; all images of a camera must have one size",
                     files[i].info.width, files[i].info.height, size.width, size.height));
    }
    return size;
}

// Values that are not 0 replace those of the scan.
Camera overridden(Camera camera, const Camera& values)
{
    for (double Camera::*value : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2})
        if (values.*value != 0.0) camera.*value = values.*value;
    return camera;
}

bool is_whole(const Camera& values)
{
    return values.fx != 0.0 && values.fy != 0.0 && values.cx != 0.0 && values.cy != 0.0;
}

// The camera for images of a size: `known` (of the scan) with `given` (of the parameters) laid over it.
Camera camera_for(const Camera& known, const Camera& given, Size size, const fs::path& folder, const std::string& kind)
{
    const bool fits = known.fx != 0.0 && (known.width == 0 || Size{known.width, known.height} == size);
    if (!fits && !is_whole(given))
        fail(folder,
             fmt::format("the {0} camera is not known for images of {1}x{2} pixels{3}; give it by --set {0}_fx=…, "
                         "{0}_fy, {0}_cx and {0}_cy [px]",
                         kind, size.width, size.height,
                         known.fx == 0.0 ? "" : fmt::format(" (the scan's is for {}x{})", known.width, known.height)));
    Camera camera = overridden(fits ? known : Camera{}, given);
    camera.width = size.width;
    camera.height = size.height;
    return camera;
}

// The same view at another size (pixel centres at integers).
Camera scaled(const Camera& camera, Size size)
{
    const double sx = static_cast<double>(size.width) / camera.width,
                 sy = static_cast<double>(size.height) / camera.height;
    return {size.width,
            size.height,
            camera.fx * sx,
            camera.fy * sy,
            (camera.cx + 0.5) * sx - 0.5,
            (camera.cy + 0.5) * sy - 0.5,
            camera.k1,
            camera.k2};
}

// What the scan itself says of its depth camera; fx = 0 when it says nothing for images of that size.
Camera known_depth_camera(const Listing& listing, Size color, Size depth)
{
    if (listing.depth.fx != 0.0) return listing.depth;
    Camera registered = listing.color; // as the scan says, whatever the parameters make of the colour camera
    registered.width = color.width;
    registered.height = color.height;
    if (listing.depth_scales_color) return scaled(registered, depth);
    return color == depth ? registered : Camera{};
}

void set_cameras(Scan& scan, const Listing& listing, const LookedAtFrames& files, const fs::path& folder,
                 const ImportParams& params)
{
    const auto& frames = listing.frames;
    const Size color = common_size(files.color, folder, [&](std::size_t i) { return frames[i].color; });
    const Size depth = common_size(files.depth, folder, [&](std::size_t i) { return frames[i].depth; });
    if (depth == Size{}) fail(folder, fmt::format("none of the {} frames has a depth image", frames.size()));
    const Camera given_color{
        0, 0, params.color_fx, params.color_fy, params.color_cx, params.color_cy, params.color_k1, params.color_k2};
    const Camera given_depth{
        0, 0, params.depth_fx, params.depth_fy, params.depth_cx, params.depth_cy, params.depth_k1, params.depth_k2};
    scan.color = camera_for(listing.color, given_color, color, folder, "color");
    scan.depth = camera_for(known_depth_camera(listing, color, depth), given_depth, depth, folder, "depth");
    scan.color.fy = std::abs(scan.color.fy); // a negative one is in the convention
    scan.depth.fy = std::abs(scan.depth.fy);
    scan.depth_unit = params.depth_unit > 0.0 ? params.depth_unit : listing.depth_unit;
    scan.max_depth = params.max_depth;
}

Rigid depth_from_color(const Listing& listing, const ImportParams& params)
{
    const Eigen::Vector3d translation(params.color_depth_tx, params.color_depth_ty, params.color_depth_tz);
    const Eigen::Vector3d rotation =
        std::numbers::pi / 180.0 * Eigen::Vector3d(params.color_depth_rx, params.color_depth_ry, params.color_depth_rz);
    if (translation.isZero(0.0) && rotation.isZero(0.0)) return orthonormalized(Rigid(listing.depth_from_color));
    Rigid transform = Rigid::Identity();
    if (!rotation.isZero(0.0))
        transform.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
    transform.translation() = translation;
    return transform;
}

PoseConvention convention_of(const Listing& listing, const ImportParams& params)
{
    PoseConvention convention = listing.convention;
    convention.flip_y = listing.color.fy < 0.0;
    if (params.pose != PoseDirection::Auto) convention.world_to_camera = params.pose == PoseDirection::WorldToCamera;
    if (params.camera_axes != CameraAxes::Auto) convention.y_up_z_back = params.camera_axes == CameraAxes::YUpZBack;
    if (params.flip_y != FlipY::Auto) convention.flip_y = params.flip_y == FlipY::Yes;
    return convention;
}

Frame make_frame(const ListedFrame& listed, const ImageFile& color, const ImageFile& depth,
                 const PoseConvention& convention)
{
    Frame frame;
    frame.time = listed.time;
    if (!listed.color.empty()) frame.color = {listed.color, color.sha256};
    if (!listed.depth.empty()) frame.depth = {listed.depth, depth.sha256};
    if (is_rigid(listed.pose))
        frame.camera_from_world = camera_from_world(listed.pose, convention);
    else
        frame.use = FrameUse::Invalid;
    return frame;
}

void hold_out_every(int n, Scan& scan)
{
    if (n <= 0) return;
    std::vector<FrameId> ids = scan.frames_in_use();
    std::erase_if(ids, [&](FrameId id) { return !scan.frames[id].has_color(); }); // there is nothing to compare with
    for (std::size_t i = static_cast<std::size_t>(n) - 1; i < ids.size(); i += static_cast<std::size_t>(n))
        scan.frames[ids[i]].use = FrameUse::HeldOut;
}

// The scan's own mesh: the named file, or the largest PLY file of the folder, as processed copies are smaller.
std::string dense_mesh_of(const fs::path& folder, const std::string& wanted)
{
    if (wanted == "none") return "";
    if (wanted != "auto") {
        if (!fs::is_regular_file(folder / wanted))
            fail(folder / wanted, "there is no such file; dense_mesh is a PLY file of the scan folder, auto, or none");
        return wanted;
    }
    std::vector<std::pair<std::uintmax_t, std::string>> meshes;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().extension() == ".ply")
            meshes.emplace_back(entry.file_size(), entry.path().filename().string());
    return meshes.empty() ? "" : std::ranges::max_element(meshes)->second;
}

ImportReport count_frames(const Scan& scan)
{
    ImportReport report;
    for (const Frame& frame : scan.frames) {
        if (frame.use == FrameUse::Used) ++report.used;
        if (frame.use == FrameUse::HeldOut) ++report.held_out;
        if (frame.use == FrameUse::Invalid && report.invalid++ == 0) report.invalid_example = frame.name();
        if (!frame.has_depth() && report.without_depth++ == 0) report.without_depth_example = frame.name();
        if (!frame.has_color() && report.without_color++ == 0) report.without_color_example = frame.name();
    }
    return report;
}

std::string flags_between(const Reading& now, const Reading& better)
{
    std::string flags;
    const auto add = [&](const std::string& flag) { flags += (flags.empty() ? "--set " : " --set ") + flag; };
    const PoseConvention &a = now.convention, &b = better.convention;
    if (a.world_to_camera != b.world_to_camera)
        add(b.world_to_camera ? "pose=world_to_camera" : "pose=camera_to_world");
    if (a.y_up_z_back != b.y_up_z_back) add(b.y_up_z_back ? "camera_axes=y_up_z_back" : "camera_axes=y_down_z_forward");
    if (a.flip_y != b.flip_y) add(b.flip_y ? "flip_y=yes" : "flip_y=no");
    if (now.depth_unit != better.depth_unit) add("depth_unit=" + format_param(better.depth_unit));
    return flags;
}

void compare_depths(const ScanImages& images, const std::vector<ListedFrame>& frames, const PoseConvention& convention,
                    const ImportParams& params, ImportReport& report)
{
    std::vector<Eigen::Matrix4d> poses;
    for (const ListedFrame& frame : frames)
        poses.push_back(frame.pose);
    const Reading current{convention, images.scan().depth_unit};
    for (double gap = params.check_gap;; gap /= 2) { // a camera that turns fast soon sees something else
        const ReprojectionCheck check(images, poses, {params.check_pairs, gap, params.check_good});
        const Reading better = check.better_reading(current, params.check_ratio);
        report.check = check.agreement(current);
        report.suggestion = flags_between(current, better);
        report.suggested = check.agreement(better);
        report.disagrees = report.suggestion.empty() && !check.is_good(report.check);
        if (check.overlaps(report.check) || !report.suggestion.empty() || check.gap() <= 1) return;
    }
}

} // namespace

ImportedScan import_scan(const fs::path& folder, const ImportParams& params)
{
    const LayoutReader& reader = find_layout(folder, params.layout);
    const Listing listing = list_frames(reader, folder, params);
    const LookedAtFrames files = look_at_all(folder, listing.frames);
    const PoseConvention convention = convention_of(listing, params);

    Scan scan;
    set_cameras(scan, listing, files, folder, params);
    scan.depth_from_color = depth_from_color(listing, params);
    for (std::size_t i = 0; i < listing.frames.size(); ++i)
        scan.frames.push_back(make_frame(listing.frames[i], files.color[i], files.depth[i], convention));
    if (scan.frames_in_use().empty())
        fail(folder, fmt::format("none of the {} frames has a valid pose (finite and rigid; for example that of {}); "
                                 "check the poses of the {} layout",
                                 scan.frames.size(), scan.frames.front().name(), reader.title));
    hold_out_every(params.hold_out, scan);
    const std::string mesh = dense_mesh_of(folder, params.dense_mesh);
    if (!mesh.empty()) scan.dense_mesh = {mesh, sha256(read_bytes(folder / mesh))};

    ImportReport report = count_frames(scan);
    report.layout = reader.title;
    report.intrinsics_source = listing.source;
    report.absent = listing.absent;
    compare_depths(ScanImages(scan, folder), listing.frames, convention, params, report);
    return {std::move(scan), std::move(report)};
}

void log_report(const ImportReport& report)
{
    log_info(fmt::format("{} layout, cameras from {}: {} frames in use, {} held out", report.layout,
                         report.intrinsics_source, report.used, report.held_out));
    if (report.absent.count > 0)
        log_warning(
            fmt::format("{} of {} files that the lists name are not in the folder and were skipped, for example {}",
                        report.absent.count, report.absent.named, report.absent.example));
    if (report.invalid > 0)
        log_warning(fmt::format("{} frames have no valid pose (finite and rigid) and are not used, for example {}",
                                report.invalid, report.invalid_example));
    if (report.without_depth > 0)
        log_warning(fmt::format("{} frames have no depth image (where lists pair them by time: none within "
                                "max_time_gap), for example {}",
                                report.without_depth, report.without_depth_example));
    if (report.without_color > 0)
        log_warning(fmt::format("{} depth images have no colour image within max_time_gap; they have poses of their "
                                "own and add to the surface, for example {}",
                                report.without_color, report.without_color_example));
    if (report.check.samples > 0)
        log_info(fmt::format("depth seen from another frame differs by {:.1f} mm in the median ({:.2f} % of the depth; "
                             "{} pixels of {} pairs)",
                             1e3 * report.check.median, 100.0 * report.check.relative, report.check.samples,
                             report.check.pairs));
    else if (report.check.pairs > 0)
        log_warning(fmt::format("in {} pairs of frames no pixel overlaps, so the poses could not be checked",
                                report.check.pairs));
    if (!report.suggestion.empty())
        log_warning(fmt::format("the depths of the scan fit much better with {} ({:.2f} % instead of {:.2f} % of the "
                                "depth): the poses or the depth "
                                "unit seem to follow another convention",
                                report.suggestion, 100.0 * report.suggested.relative, 100.0 * report.check.relative));
    if (report.disagrees)
        log_warning(fmt::format("depth seen from another frame differs by {:.1f} % of the depth in the median, and no "
                                "other convention fits: poses and depth images do not belong together. Check their "
                                "order and times, and whether tracking was lost",
                                100.0 * report.check.relative));
}

} // namespace quoin
