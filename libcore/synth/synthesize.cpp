#include "synth/synthesize.h"

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "image/image_io.h"
#include "synth/camera_path.h"
#include "synth/furnish.h"
#include "synth/sensor.h"
#include "synth/truth.h"

#include <fmt/format.h>

namespace quoin {
namespace {

// True poses of both cameras.
struct Rig {
    std::vector<View> depth, color;
    Rigid depth_from_color = Rigid::Identity();
};

Rig place_cameras(const SynthParams& params)
{
    Rig rig;
    rig.depth_from_color.translation().x() = params.color_offset;
    const Camera camera = sensor_camera(params);
    for (const Rigid& world_from_depth : hand_held_path(params)) {
        rig.depth.push_back({camera, world_from_depth});
        rig.color.push_back({camera, world_from_depth * rig.depth_from_color});
    }
    return rig;
}

std::string matrix_text(const Eigen::Matrix4d& m, const char* column_end, const char* row_end)
{
    std::string text;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            text += fmt::format("{:.9f}{}", m(r, c), c < 3 ? column_end : row_end);
    return text;
}

std::string info_text(const Camera& camera, const Rigid& depth_from_color, int frames)
{
    Eigen::Matrix4d intrinsic = Eigen::Matrix4d::Identity();
    intrinsic(0, 0) = camera.fx, intrinsic(1, 1) = camera.fy, intrinsic(0, 2) = camera.cx, intrinsic(1, 2) = camera.cy;
    const auto row = [](const Eigen::Matrix4d& m) { return matrix_text(m, " ", " "); };
    std::string text = fmt::format(
        "m_versionNumber = 4\nm_sensorName = Synthetic\n"
        "m_colorWidth = {0}\nm_colorHeight = {1}\nm_depthWidth = {0}\nm_depthHeight = {1}\nm_depthShift = 1000\n",
        camera.width, camera.height);
    text += "m_calibrationColorIntrinsic = " + row(intrinsic) + "\n";
    text += "m_calibrationColorExtrinsic = " + row(depth_from_color.matrix()) + "\n";
    text += "m_calibrationDepthIntrinsic = " + row(intrinsic) + "\n";
    text += "m_calibrationDepthExtrinsic = " + row(Eigen::Matrix4d::Identity()) + "\n";
    return text + fmt::format("m_frames.size = {}\n", frames);
}

struct Capture {
    const PaintedRoom& room;
    const Rig& rig;
    const std::vector<FrameErrors>& errors;
    const SynthParams& params;
};

void capture_frame(const Capture& capture, std::size_t i, const std::filesystem::path& folder)
{
    const auto& [room, rig, errors, params] = capture;
    const FrameErrors& e = errors[i];
    const ColorField truth =
        e.spin.isZero() ? render_color(room, rig.color[i]) : render_moving(room, exposure_views(rig.color[i], e.spin));
    const ColorImage color = expose(truth, e.exposure, params, i);
    const Image<std::uint16_t> depth = sense_depth(render_depth(room, rig.depth[i]), params, i);
    const Rigid recorded = rig.depth[i].world_from_camera * e.true_from_recorded;
    const auto file = [&](const char* end) { return folder / fmt::format("frame-{:06}.{}", i, end); };
    write_atomically(file("color.jpg"), encode_jpeg(color, params.jpeg_quality));
    write_atomically(file("depth.png"), encode_png(depth));
    write_atomically(file("pose.txt"), matrix_text(recorded.matrix(), " ", "\n"));
}

GroundTruth collect_truth(const Capture& capture)
{
    GroundTruth truth = survey_room(capture.room, capture.rig.depth, capture.params);
    for (std::size_t i = 0; i < capture.rig.depth.size(); ++i) {
        truth.time.push_back(static_cast<double>(i) * capture.params.frame_interval);
        truth.world_from_camera.push_back(capture.rig.depth[i].world_from_camera);
        truth.exposure.push_back(capture.errors[i].exposure);
    }
    return truth;
}

} // namespace

void synthesize_scan(const SynthParams& params, const std::filesystem::path& folder)
{
    const PaintedRoom room = paint_room(furnish_room(params), params.texel_size);
    const Rig rig = place_cameras(params);
    const std::vector<FrameErrors> errors = draw_frame_errors(params);
    const Capture capture{room, rig, errors, params};
    Progress progress("taking frames", rig.depth.size());
    parallel_for(rig.depth.size(), [&](std::size_t i) {
        capture_frame(capture, i, folder);
        progress.step();
    });
    write_atomically(folder / "info.txt", info_text(sensor_camera(params), rig.depth_from_color, params.frames));
    std::filesystem::create_directories(folder / "ground_truth");
    write_ground_truth(folder / "ground_truth", collect_truth(capture));
}

} // namespace quoin
