// Do poses, cameras and depth unit of a scan belong together? Depth of one frame, seen from another, must agree.
#pragma once

#include "scan/convention.h"
#include "scan/scan.h"

namespace quoin {

// How the depths of sampled frame pairs agree.
struct ScanCheck {
    std::size_t pairs = 0;   // frame pairs compared
    std::size_t samples = 0; // pixels compared; 0 = nothing overlaps
    double median = 0.0;     // median of |z - depth| [m]
    double relative = 0.0;   // median of |z - depth| / z
};

struct CheckSettings {
    int pairs = 20;
    double gap = 0.67;  // between the frames of a pair [s]; at least one frame, at most half the scan
    double good = 0.05; // ScanCheck::relative up to which the depths agree
};

// One way to read a scan: the convention of its poses and its depth unit.
struct Reading {
    PoseConvention convention;
    double depth_unit = 0.001; // [m]
};

// Poses as listed, one per frame of the scan.
class ReprojectionCheck {
public:
    // Reads the depth of evenly spread pairs (i, i + n) of frames that are in use and have depth.
    ReprojectionCheck(const ScanImages& images, std::vector<Eigen::Matrix4d> listed_poses,
                      const CheckSettings& settings);

    // Agreement if the scan is read that way.
    ScanCheck agreement(const Reading& reading) const;

    // Frames from one of a pair to the other.
    std::size_t gap() const { return gap_; }

    // Whether the depths agree, as far as any could be compared.
    bool is_good(const ScanCheck& check) const { return check.samples == 0 || check.relative <= good_; }

    // Whether a tenth of the pixels could be compared: below, agreement is chance.
    bool overlaps(const ScanCheck& check) const;

    // The reading that overlaps, is good, fits at least `ratio` times better than `current` and compares at least half
    // as many pixels: inverted poses, other axes, flipped y, other common depth units. The one with fewest changes
    // among equals. Returns `current` itself when there is none.
    Reading better_reading(const Reading& current, double ratio) const;

private:
    struct View {
        Eigen::Matrix4d listed;
        Image<float> steps; // depth in steps of the file; 0 = missing
    };
    struct Pair {
        std::size_t from, to; // into views_
    };
    Camera camera_;
    std::vector<View> views_;
    std::vector<Pair> pairs_;
    std::size_t gap_ = 1;
    double good_ = 0.0;
};

} // namespace quoin
