// From a scan folder in any known layout to a canonical table of frames.
#pragma once

#include "base/param.h"
#include "scan/check.h"
#include "scan/layout.h"
#include "scan/scan.h"

namespace quoin {

enum class PoseDirection { Auto, CameraToWorld, WorldToCamera };
constexpr auto choice_names(PoseDirection) { return std::array{"auto", "camera_to_world", "world_to_camera"}; }
enum class CameraAxes { Auto, YDownZForward, YUpZBack };
constexpr auto choice_names(CameraAxes) { return std::array{"auto", "y_down_z_forward", "y_up_z_back"}; }
enum class FlipY { Auto, No, Yes };
constexpr auto choice_names(FlipY) { return std::array{"auto", "no", "yes"}; }

// Zero means "as the scan or its layout says" wherever a value of the scan can be overridden.
struct ImportParams {
    Layout layout = Layout::Auto;
    PoseDirection pose = PoseDirection::Auto;
    CameraAxes camera_axes = CameraAxes::Auto;
    FlipY flip_y = FlipY::Auto;
    double color_fx = 0.0, color_fy = 0.0, color_cx = 0.0, color_cy = 0.0, color_k1 = 0.0, color_k2 = 0.0;
    double depth_fx = 0.0, depth_fy = 0.0, depth_cx = 0.0, depth_cy = 0.0, depth_k1 = 0.0, depth_k2 = 0.0;
    double color_depth_tx = 0.0, color_depth_ty = 0.0, color_depth_tz = 0.0;
    double color_depth_rx = 0.0, color_depth_ry = 0.0, color_depth_rz = 0.0;
    double depth_unit = 0.0;
    double max_depth = 0.0;
    double max_time_gap = 0.02;
    int frame_step = 1;
    int max_frames = 0;
    int hold_out = 0;
    std::string dense_mesh = "auto";
    int check_pairs = 20;
    double check_gap = 0.67;
    double check_ratio = 2.0;
    double check_good = 0.05;

    static constexpr auto list()
    {
        using P = ImportParams;
        constexpr double any = std::numeric_limits<double>::infinity();
        constexpr ParamFlags report_only{.affects_result = false};
        return std::tuple{
            Param{"layout", &P::layout, "", "how the folder is laid out; auto looks at it"},
            Param{"pose", &P::pose, "", "what the poses of the files map; auto is the layout's convention"},
            Param{"camera_axes", &P::camera_axes, "", "axes of the files' cameras; auto is the layout's convention"},
            Param{"flip_y", &P::flip_y, "", "do the poses belong to a camera with fy < 0? auto looks at fy"},
            Param{"color_fx", &P::color_fx, "px", "focal length of the colour camera along x; 0 = from the scan", 0.0},
            Param{"color_fy", &P::color_fy, "px", "focal length of the colour camera along y; 0 = from the scan", 0.0},
            Param{"color_cx", &P::color_cx, "px", "principal point of the colour camera along x; 0 = from the scan",
                  0.0},
            Param{"color_cy", &P::color_cy, "px", "principal point of the colour camera along y; 0 = from the scan",
                  0.0},
            Param{"color_k1", &P::color_k1, "", "radial distortion r^2 of the colour images; 0 = from the scan", -10.0,
                  10.0},
            Param{"color_k2", &P::color_k2, "", "radial distortion r^4 of the colour images; 0 = from the scan", -10.0,
                  10.0},
            Param{"depth_fx", &P::depth_fx, "px", "focal length of the depth camera along x; 0 = from the scan", 0.0},
            Param{"depth_fy", &P::depth_fy, "px", "focal length of the depth camera along y; 0 = from the scan", 0.0},
            Param{"depth_cx", &P::depth_cx, "px", "principal point of the depth camera along x; 0 = from the scan",
                  0.0},
            Param{"depth_cy", &P::depth_cy, "px", "principal point of the depth camera along y; 0 = from the scan",
                  0.0},
            Param{"depth_k1", &P::depth_k1, "", "radial distortion r^2 of the depth images; 0 = from the scan", -10.0,
                  10.0},
            Param{"depth_k2", &P::depth_k2, "", "radial distortion r^4 of the depth images; 0 = from the scan", -10.0,
                  10.0},
            Param{"color_depth_tx", &P::color_depth_tx, "m", "x of the colour camera's centre in the depth camera",
                  -1.0, 1.0},
            Param{"color_depth_ty", &P::color_depth_ty, "m", "y of the colour camera's centre in the depth camera",
                  -1.0, 1.0},
            Param{"color_depth_tz", &P::color_depth_tz, "m", "z of the colour camera's centre in the depth camera",
                  -1.0, 1.0},
            Param{"color_depth_rx", &P::color_depth_rx, "deg", "x of the rotation vector from colour to depth axes",
                  -180.0, 180.0},
            Param{"color_depth_ry", &P::color_depth_ry, "deg", "y of the rotation vector from colour to depth axes",
                  -180.0, 180.0},
            Param{"color_depth_rz", &P::color_depth_rz, "deg", "z of the rotation vector from colour to depth axes",
                  -180.0, 180.0},
            Param{"depth_unit", &P::depth_unit, "m", "metres a step of the depth files; 0 = from the scan", 0.0, 1.0},
            Param{"max_depth", &P::max_depth, "m", "depths beyond are taken as missing; 0 = no limit", 0.0, any},
            Param{"max_time_gap", &P::max_time_gap, "s",
                  "largest gap of the times of a colour image, its depth and its pose", 0.0, 10.0},
            Param{"frame_step", &P::frame_step, "", "take every n-th frame", 1.0, 1e6},
            Param{"max_frames", &P::max_frames, "", "take at most so many frames; 0 = all", 0.0, 1e9},
            Param{"hold_out", &P::hold_out, "", "every n-th frame is kept from all stages but evaluate; 0 = none", 0.0,
                  1e9},
            Param{"dense_mesh", &P::dense_mesh, "",
                  "the scan's own dense mesh: a PLY file of the folder, auto, or none"},
            Param{"check_pairs", &P::check_pairs, "", "pairs of frames whose depth is compared; 0 = no comparison", 0.0,
                  1000.0, report_only},
            Param{"check_gap", &P::check_gap, "s", "time between the two frames of a pair; 20 frames at 30 Hz", 0.0,
                  1e6, report_only},
            Param{"check_ratio", &P::check_ratio, "", "report a convention that fits so many times better", 1.0, 1e6,
                  report_only},
            Param{"check_good", &P::check_good, "", "largest median difference of depths that agree", 0.0, 1.0,
                  report_only},
        };
    }
};

struct ImportReport {
    std::string layout;                              // title of the layout
    std::string intrinsics_source;                   // "camera-intrinsics.txt", "published for TUM fr3"
    std::size_t used = 0, held_out = 0, invalid = 0; // frames
    std::size_t without_depth = 0, without_color = 0;
    std::string invalid_example;       // file of the first frame with an invalid pose
    std::string without_depth_example; // colour file of the first frame without depth
    std::string without_color_example; // depth file of the first frame without colour
    AbsentFiles absent;
    ScanCheck check;
    std::string suggestion; // flags that fit several times better, "--set pose=world_to_camera"; "" = none
    ScanCheck suggested;    // agreement with these flags
    bool disagrees = false; // depths differ by more than check_good, and no flags help
};

struct ImportedScan {
    Scan scan;
    ImportReport report;
};

// Reads the folder's lists, poses and calibration, hashes every file and looks at its header, and compares the depth of
// sampled frames. Throws InputError for a folder or file that cannot be used (see find_layout).
ImportedScan import_scan(const std::filesystem::path& folder, const ImportParams& params);

// The report as log lines: what was found, warnings with counts and an example, and how well depth agrees.
void log_report(const ImportReport& report);

} // namespace quoin
