// An invented scan: a furnished room, a hand-held camera, and a sensor's errors, each with its parameter.
#pragma once

#include "base/param.h"

#include <cstdint>
#include <filesystem>

namespace quoin {

struct SynthParams {
    std::int64_t seed = 1;
    int frames = 150;
    int width = 640;
    int height = 480;
    double focal = 525.0;
    double room_width = 4.6;
    double room_length = 3.8;
    double room_height = 2.5;
    int furniture = 8;
    double texel_size = 0.002;
    double frame_interval = 0.1;
    double hand_jitter = 0.01;
    double depth_noise = 0.0012;
    double depth_step = 0.001;
    double edge_holes = 1.5;
    double grazing_limit = 80.0;
    double min_depth = 0.35;
    double max_depth = 6.0;
    double exposure_drift = 0.25;
    double white_balance_drift = 0.06;
    double black_level_drift = 3.0;
    double vignetting = 0.12;
    double image_noise = 2.0;
    double blurred_frames = 0.3;
    double blur_length = 6.0;
    double pose_drift = 0.01;
    double pose_drift_angle = 0.5;
    double color_offset = 0.02;
    int jpeg_quality = 95;
    int truth_samples = 200000;
    double truth_edge = 0.05;

    static constexpr auto list()
    {
        using P = SynthParams;
        return std::tuple{
            Param{"seed", &P::seed, "", "chooses the room, its textures, the camera's path and every error", 0.0, 1e9},
            Param{"frames", &P::frames, "", "number of frames", 1.0, 100000.0},
            Param{"width", &P::width, "px", "width of the colour and the depth images", 32.0, 4096.0},
            Param{"height", &P::height, "px", "height of the colour and the depth images", 24.0, 4096.0},
            Param{"focal", &P::focal, "px", "focal length of both cameras", 16.0, 8192.0},
            Param{"room_width", &P::room_width, "m", "extent of the room along x", 2.5, 12.0},
            Param{"room_length", &P::room_length, "m", "extent of the room along y", 2.5, 12.0},
            Param{"room_height", &P::room_height, "m", "extent of the room along z", 2.2, 5.0},
            Param{"furniture", &P::furniture, "",
                  "pieces of furniture to place as far as there is space; 0 = an empty room", 0.0, 40.0},
            Param{"texel_size", &P::texel_size, "m", "size of a texel of the true textures", 0.0005, 0.05},
            Param{"frame_interval", &P::frame_interval, "s", "time between two frames", 0.001, 10.0},
            Param{"hand_jitter", &P::hand_jitter, "m",
                  "amplitude of the hand's tremble; the angles follow in proportion", 0.0, 0.1},
            Param{"depth_noise", &P::depth_noise, "m",
                  "standard deviation of depth at 1 m; grows with the square of depth", 0.0, 0.1},
            Param{"depth_step", &P::depth_step, "m", "quantisation of depth at 1 m; grows with the square of depth",
                  0.0, 0.1},
            Param{"edge_holes", &P::edge_holes, "px",
                  "width of the strip beside a jump of depth that is missing; 0 = none", 0.0, 20.0},
            Param{"grazing_limit", &P::grazing_limit, "deg",
                  "depth seen at a flatter angle to the normal is missing; 0 = none is", 0.0, 90.0},
            Param{"min_depth", &P::min_depth, "m", "nearer depth is missing; 0 = none is", 0.0, 10.0},
            Param{"max_depth", &P::max_depth, "m", "farther depth is missing; 0 = none is", 0.0, 60.0},
            Param{"exposure_drift", &P::exposure_drift, "",
                  "largest deviation of the exposure gain from 1 over the scan", 0.0, 0.9},
            Param{"white_balance_drift", &P::white_balance_drift, "",
                  "largest deviation of a channel's gain from the exposure", 0.0, 0.5},
            Param{"black_level_drift", &P::black_level_drift, "", "largest bias of a channel, in grey levels of 255",
                  0.0, 50.0},
            Param{"vignetting", &P::vignetting, "", "loss of light in the corners of the image", 0.0, 0.9},
            Param{"image_noise", &P::image_noise, "", "standard deviation of colour noise, in grey levels of 255", 0.0,
                  50.0},
            Param{"blurred_frames", &P::blurred_frames, "", "fraction of the frames with motion blur", 0.0, 1.0},
            Param{"blur_length", &P::blur_length, "px",
                  "largest path of the image centre during an exposure of a blurred frame", 0.0, 100.0},
            Param{"pose_drift", &P::pose_drift, "m", "largest error of a recorded position; a smooth random walk", 0.0,
                  1.0},
            Param{"pose_drift_angle", &P::pose_drift_angle, "deg",
                  "largest error of a recorded rotation; a smooth random walk", 0.0, 20.0},
            Param{"color_offset", &P::color_offset, "m",
                  "distance of the colour camera to the right of the depth camera", 0.0, 0.2},
            Param{"jpeg_quality", &P::jpeg_quality, "", "quality of the colour files", 1.0, 100.0},
            Param{"truth_samples", &P::truth_samples, "", "surface points with true colours in the ground truth", 0.0,
                  1e8},
            Param{"truth_edge", &P::truth_edge, "m", "longest edge of the ground-truth mesh", 0.005, 10.0},
        };
    }
};

// Fills the empty folder with a scan in BundleFusion's layout (frame-%06d.color.jpg, .depth.png in millimetres,
// .pose.txt camera to world of the depth camera, info.txt) and ground_truth/ (mesh/ground_truth.h). The same parameters
// give the same bytes for any number of threads. Throws InputError or ResourceError when a file cannot be written.
void synthesize_scan(const SynthParams& params, const std::filesystem::path& folder);

} // namespace quoin
