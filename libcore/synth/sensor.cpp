#include "synth/sensor.h"

#include "synth/camera_path.h"
#include "synth/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMillimetres = 1000.0; // of the depth file [1/m]
constexpr double kDepthJump = 0.02;     // of depth, between neighbours of two surfaces
constexpr double kEdgeLoss = 0.75;      // chance of a pixel beside a jump to be missing
constexpr int kMostBlurPoses = 24;

// Is there a jump of depth within `radius` pixels?
bool beside_jump(const DepthImage& depth, int x, int y, double radius)
{
    const int reach = static_cast<int>(std::ceil(radius));
    const float z = depth.at(x, y);
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
            if (dx * dx + dy * dy > radius * radius || !depth.contains(x + dx, y + dy)) continue;
            // Beyond the jump that a slanted surface makes by itself.
            const float other = depth.at(x + dx, y + dy),
                        opposite = depth.contains(x - dx, y - dy) ? depth.at(x - dx, y - dy) : z;
            const double bend = std::abs(static_cast<double>(other) + opposite - 2.0 * z);
            if (bend > kDepthJump * z) return true;
        }
    return false;
}

bool too_flat(double cosine, double limit_deg, double draw)
{
    if (limit_deg <= 0.0) return false;
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) / kDegree;
    return draw < (angle - limit_deg + kGrazingFade) / kGrazingFade;
}

} // namespace

std::vector<FrameErrors> draw_frame_errors(const SynthParams& params)
{
    enum : std::uint64_t { kTurnWalk, kPlaceWalk, kExposureWalk, kBalanceWalk, kBlackWalk };
    const Eigen::MatrixXd turn = smooth_walk(params, kTurnWalk, 3), place = smooth_walk(params, kPlaceWalk, 3);
    const Eigen::MatrixXd light = smooth_walk(params, kExposureWalk, 1), balance = smooth_walk(params, kBalanceWalk, 3),
                          black = smooth_walk(params, kBlackWalk, 3);
    std::vector<FrameErrors> errors(static_cast<std::size_t>(params.frames));
    for (int i = 0; i < params.frames; ++i) {
        FrameErrors& e = errors[static_cast<std::size_t>(i)];
        Twist drift;
        drift.head<3>() = params.pose_drift_angle * kDegree * turn.col(i);
        drift.tail<3>() = params.pose_drift * place.col(i);
        e.true_from_recorded.linear() = exp_twist(drift).linear();
        e.true_from_recorded.translation() = drift.tail<3>();
        const double gain = 1.0 + params.exposure_drift * light(0, i);
        e.exposure.gain = (gain * (1.0 + params.white_balance_drift * balance.col(i).array())).matrix();
        e.exposure.bias = params.black_level_drift * black.col(i);
        CounterRandom random(static_cast<std::uint64_t>(params.seed), RandomPurpose::Blur,
                             static_cast<std::uint64_t>(i));
        if (random.uniform() >= params.blurred_frames) continue;
        const double angle = params.blur_length / params.focal * random.uniform(0.4, 1.0),
                     way = random.uniform(0.0, 2.0 * std::numbers::pi);
        e.spin = angle * Vector3d(std::cos(way), std::sin(way), random.uniform(-0.5, 0.5));
    }
    return errors;
}

std::vector<View> exposure_views(const View& view, const Vector3d& spin)
{
    const int poses = std::clamp(static_cast<int>(std::ceil(spin.norm() * view.camera.fx * 1.5)), 4, kMostBlurPoses);
    std::vector<View> views;
    for (int i = 0; i < poses; ++i) {
        Twist turn = Twist::Zero();
        turn.head<3>() = ((i + 0.5) / poses - 0.5) * spin;
        views.push_back({view.camera, view.world_from_camera * exp_twist(turn)});
    }
    return views;
}

ColorImage expose(const ColorField& truth, const TrueExposure& exposure, const SynthParams& params, std::uint64_t frame)
{
    ColorImage image(truth.width, truth.height);
    const double cx = 0.5 * (truth.width - 1), cy = 0.5 * (truth.height - 1), corner = cx * cx + cy * cy;
    for (int y = 0; y < truth.height; ++y)
        for (int x = 0; x < truth.width; ++x) {
            const double light = 1.0 - params.vignetting * ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / corner;
            CounterRandom random(static_cast<std::uint64_t>(params.seed), RandomPurpose::Color, frame,
                                 static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(truth.width) +
                                     static_cast<std::uint64_t>(x));
            for (int c = 0; c < 3; ++c) {
                const double noise = params.image_noise > 0.0 ? params.image_noise * random.gaussian() : 0.0;
                const double value =
                    light * (exposure.gain[c] * static_cast<double>(truth.at(x, y)[c]) + exposure.bias[c]) + noise;
                image.at(x, y)[static_cast<std::size_t>(c)] =
                    static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
            }
        }
    return image;
}

Image<std::uint16_t> sense_depth(const ExactDepth& truth, const SynthParams& params, std::uint64_t frame)
{
    Image<std::uint16_t> image(truth.depth.width, truth.depth.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double z = static_cast<double>(truth.depth.at(x, y));
            CounterRandom random(static_cast<std::uint64_t>(params.seed), RandomPurpose::Depth, frame,
                                 static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(image.width) +
                                     static_cast<std::uint64_t>(x));
            const double flat_draw = random.uniform(), edge_draw = random.uniform(), error = random.gaussian();
            if (z <= 0.0 || z < params.min_depth || (params.max_depth > 0.0 && z > params.max_depth)) continue;
            if (too_flat(static_cast<double>(truth.cosine.at(x, y)), params.grazing_limit, flat_draw)) continue;
            if (params.edge_holes > 0.0 && edge_draw < kEdgeLoss && beside_jump(truth.depth, x, y, params.edge_holes))
                continue;
            const double step = params.depth_step * z * z;
            double sensed = z + params.depth_noise * z * z * error;
            if (step > 0.0) sensed = std::round(sensed / step) * step;
            image.at(x, y) = static_cast<std::uint16_t>(std::clamp(sensed * kMillimetres + 0.5, 0.0, 65534.0));
        }
    return image;
}

} // namespace quoin
