#include "synth/camera_path.h"

#include "synth/random.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr double kTurns = 4.0;        // of the look direction
constexpr double kNods = 10.0;        // a turn after the next meets every direction in the opposite half of a nod
constexpr double kEyeHeight = 1.5;    // [m]
constexpr double kFromWall = 1.25;    // least distance of the walk to a wall [m]
constexpr double kTrembleAngle = 1.0; // a hand's angle for its way [rad/m]
constexpr int kWalkSmoothing = 6;     // frames over which a random walk is smoothed

// Sum of three slow sines of random phase, about -1..1.
double tremble(std::uint64_t seed, std::uint64_t axis, double seconds)
{
    CounterRandom random(seed, RandomPurpose::Path, axis);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double frequency = random.uniform(0.3, 1.6), phase = random.uniform(0.0, 2.0 * std::numbers::pi);
        sum += std::sin(2.0 * std::numbers::pi * frequency * seconds + phase) / 3.0;
    }
    return sum;
}

// +x right, +y down, +z along the look direction.
Rigid looking(const Vector3d& eye, double yaw, double pitch)
{
    const Vector3d forward(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
    const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
    Rigid pose = Rigid::Identity();
    pose.linear().col(0) = right;
    pose.linear().col(1) = forward.cross(right);
    pose.linear().col(2) = forward;
    pose.translation() = eye;
    return pose;
}

} // namespace

Camera sensor_camera(const SynthParams& params)
{
    return {
        params.width, params.height, params.focal, params.focal, 0.5 * (params.width - 1), 0.5 * (params.height - 1)};
}

std::vector<Rigid> hand_held_path(const SynthParams& params)
{
    const auto seed = static_cast<std::uint64_t>(params.seed);
    CounterRandom random(seed, RandomPurpose::Path);
    const double start = random.uniform(0.0, 2.0 * std::numbers::pi), walk = random.uniform(0.3, 0.6);
    const double reach_x = std::max(0.1, 0.5 * params.room_width - kFromWall),
                 reach_y = std::max(0.1, 0.5 * params.room_length - kFromWall);
    const double eye = std::min(kEyeHeight, params.room_height - 0.5);
    std::vector<Rigid> path;
    for (int i = 0; i < params.frames; ++i) {
        const double t = (i + 0.5) / params.frames, seconds = i * params.frame_interval;
        const double yaw = start + 2.0 * std::numbers::pi * kTurns * t;
        const double place =
            yaw +
            std::numbers::pi * (1.0 + walk * std::sin(2.0 * std::numbers::pi * 1.3 * t)); // mostly across the room
        const double pitch = -0.12 + 0.45 * std::sin(2.0 * std::numbers::pi * (t - 0.02)) +
                             0.40 * std::sin(2.0 * std::numbers::pi * kNods * t);
        const Vector3d position(reach_x * std::cos(place), reach_y * std::sin(place),
                                eye + 0.12 * std::sin(2.0 * std::numbers::pi * 2.0 * t));
        Twist hand;
        for (int k = 0; k < 6; ++k) {
            const double amplitude = k < 3 ? params.hand_jitter * kTrembleAngle : params.hand_jitter;
            hand[k] = amplitude * tremble(seed, static_cast<std::uint64_t>(k) + 1, seconds);
        }
        path.push_back(looking(position, yaw, pitch) * exp_twist(hand));
    }
    return path;
}

Eigen::MatrixXd smooth_walk(const SynthParams& params, std::uint64_t stream, int dimensions)
{
    const int frames = params.frames;
    CounterRandom random(static_cast<std::uint64_t>(params.seed), RandomPurpose::Drift, stream);
    Eigen::MatrixXd walk = Eigen::MatrixXd::Zero(dimensions, frames + 2 * kWalkSmoothing + 1);
    for (Eigen::Index i = 1; i < walk.cols(); ++i)
        for (Eigen::Index d = 0; d < dimensions; ++d)
            walk(d, i) = walk(d, i - 1) + random.gaussian();
    Eigen::MatrixXd smooth(dimensions, frames);
    for (int i = 0; i < frames; ++i)
        smooth.col(i) = walk.middleCols(i, 2 * kWalkSmoothing + 1).rowwise().mean();
    smooth.colwise() -= Eigen::VectorXd(smooth.rowwise().mean());
    const double largest = smooth.colwise().norm().maxCoeff();
    return largest > 0.0 ? Eigen::MatrixXd(smooth / largest) : smooth;
}

} // namespace quoin
