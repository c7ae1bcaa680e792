// Data set layouts: what the files of a scan folder say, before parameters, checks and conventions are applied.
// One reader file per layout.
#pragma once

#include "geometry/camera.h"
#include "scan/convention.h"

#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace quoin {

enum class Layout { Auto, BundleFusion, SevenScenes, ScannerApp, Numbered, IclNuim, Tum, Redwood };
constexpr auto choice_names(Layout)
{
    return std::array{"auto", "bundlefusion", "seven_scenes", "scanner_app", "numbered", "icl_nuim", "tum", "redwood"};
}

struct ListedFrame {
    std::string color; // relative to the scan folder; exists; "" = none
    std::string depth; // likewise; a frame has one of them at least
    Eigen::Matrix4d pose =
        Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN()); // as written; NaN = none
    double time = 0.0;                                                       // [s]
};

// Files that lists name and the folder lacks.
struct AbsentFiles {
    std::size_t count = 0;
    std::size_t named = 0; // all that the lists name
    std::string example;
};

struct Listing {
    std::vector<ListedFrame> frames; // in the order they were taken
    AbsentFiles absent;
    PoseConvention convention;
    Camera color; // fx = 0: not known. fy < 0 is possible (PoseConvention::flip_y). width = 0: that of the images
    Camera depth; // fx = 0: the colour camera
    bool depth_scales_color = false; // depth is the colour camera's view at another size
    Eigen::Matrix4d depth_from_color = Eigen::Matrix4d::Identity();
    double depth_unit = 0.001; // metres a step
    std::string source;        // where the intrinsics come from, for messages
};

struct LayoutReader {
    Layout layout;
    const char* title; // "TUM RGB-D"
    const char* needs; // the files that make the layout
    bool (*recognises)(const std::filesystem::path& folder);
    // Throws InputError for a list or calibration that cannot be read.
    Listing (*read)(const std::filesystem::path& folder, double max_time_gap);
};

extern const LayoutReader kBundleFusionReader;
extern const LayoutReader kSevenScenesReader;
extern const LayoutReader kScannerAppReader;
extern const LayoutReader kNumberedReader;
extern const LayoutReader kIclNuimReader;
extern const LayoutReader kTumReader;
extern const LayoutReader kRedwoodReader;

// The reader for a folder: the given layout's, or the first that recognises it. Throws InputError for a folder that is
// missing, empty or of no known layout, naming what was tried and what each layout needs.
const LayoutReader& find_layout(const std::filesystem::path& folder, Layout layout);

} // namespace quoin
