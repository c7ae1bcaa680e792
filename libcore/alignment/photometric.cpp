#include "alignment/photometric.h"

#include "base/lanes.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace quoin {
namespace {

constexpr float kMinDepth = 1e-3f; // [m]; points nearer to the camera plane have no pixel
constexpr std::size_t kColorGrain = 4096;

constexpr std::size_t kBatch = 64;
using Values = std::array<float, kBatch>;
using Offsets = std::array<int, kBatch>;

// A run ready to be sampled: from points by way of their projection onto the plane to pixels of a level.
struct RunSampler {
    const GrayImage& gray;
    Eigen::Matrix<float, 3, 4> color_from_point;
    float fx, fy, cx, cy;
};

struct Points {
    alignas(32) Values x, y, z; // [m], world
};

struct Pixels {
    alignas(32) Values x, y;                    // place of the point: X/Z, Y/Z
    alignas(32) Values seen, in_row, in_column; // 1 or 0: before the camera, not clamped in x, not clamped in y
    alignas(32) Values along, down;             // 0..1, from the pixel at `offset` to the next ones
    alignas(32) Offsets offset;
};

struct Corners {
    alignas(32) Values left, right, lower_left, lower_right;
};

RunSampler run_sampler(const GrayImage& gray, const Camera& camera, const Rigid& color_from_world,
                       const CenteredPlane& plane)
{
    const Eigen::Affine3d color_from_point = color_from_world * plane.projection();
    return {gray,
            color_from_point.matrix().topRows<3>().cast<float>(),
            static_cast<float>(camera.fx),
            static_cast<float>(camera.fy),
            static_cast<float>(camera.cx),
            static_cast<float>(camera.cy)};
}

// What is missing to full lanes repeats the last point.
void gather(Points& points, const Texels& texels, const TexelId* texel, std::size_t count, std::size_t padded)
{
    for (std::size_t i = 0; i < padded; ++i) {
        const Eigen::Vector3f& p = texels.p_world[texel[std::min(i, count - 1)]];
        points.x[i] = p.x();
        points.y[i] = p.y();
        points.z[i] = p.z();
    }
}

void project(Pixels& pixels, const RunSampler& run, const Points& points, std::size_t padded)
{
    const Eigen::Matrix<float, 3, 4> A = run.color_from_point;
    const float x_max = static_cast<float>(run.gray.width) - 1.001f;
    const float y_max = static_cast<float>(run.gray.height) - 1.001f;
    const int stride = run.gray.width;
    for (std::size_t i = 0; i < padded; ++i) {
        const float X = A(0, 0) * points.x[i] + A(0, 1) * points.y[i] + A(0, 2) * points.z[i] + A(0, 3);
        const float Y = A(1, 0) * points.x[i] + A(1, 1) * points.y[i] + A(1, 2) * points.z[i] + A(1, 3);
        const float Z = A(2, 0) * points.x[i] + A(2, 1) * points.y[i] + A(2, 2) * points.z[i] + A(2, 3);
        const float inverse = 1.0f / (Z >= kMinDepth ? Z : kMinDepth);
        const float u = run.fx * (X * inverse) + run.cx, v = run.fy * (Y * inverse) + run.cy;
        const float in_x = u < x_max ? u : x_max, in_y = v < y_max ? v : y_max;
        const float column = in_x > 0.0f ? in_x : 0.0f, row = in_y > 0.0f ? in_y : 0.0f;
        const int x0 = static_cast<int>(column), y0 = static_cast<int>(row);
        pixels.x[i] = X * inverse;
        pixels.y[i] = Y * inverse;
        pixels.seen[i] = Z >= kMinDepth ? 1.0f : 0.0f;
        pixels.in_row[i] = column == u ? 1.0f : 0.0f;
        pixels.in_column[i] = row == v ? 1.0f : 0.0f;
        pixels.along[i] = column - static_cast<float>(x0);
        pixels.down[i] = row - static_cast<float>(y0);
        pixels.offset[i] = y0 * stride + x0;
    }
}

void fetch(Corners& corners, const GrayImage& gray, const Offsets& offset, std::size_t padded)
{
    for (std::size_t i = 0; i < padded; ++i) {
        const float* upper = gray.pixels.data() + offset[i];
        const float* lower = upper + gray.width;
        corners.left[i] = upper[0];
        corners.right[i] = upper[1];
        corners.lower_left[i] = lower[0];
        corners.lower_right[i] = lower[1];
    }
}

struct Greys {
    alignas(32) Values value, by_x, by_y;
};

// The bilinear surface and its exact derivative.
void interpolate(Greys& greys, const RunSampler& run, const Pixels& pixels, const Corners& corners, std::size_t padded)
{
    for (std::size_t i = 0; i < padded; ++i) {
        const float slope_upper = corners.right[i] - corners.left[i];
        const float slope_lower = corners.lower_right[i] - corners.lower_left[i];
        const float upper = corners.left[i] + pixels.along[i] * slope_upper;
        const float lower = corners.lower_left[i] + pixels.along[i] * slope_lower;
        greys.value[i] = pixels.seen[i] * (upper + pixels.down[i] * (lower - upper));
        greys.by_x[i] =
            pixels.seen[i] * pixels.in_row[i] * (run.fx * (slope_upper + pixels.down[i] * (slope_lower - slope_upper)));
        greys.by_y[i] = pixels.seen[i] * pixels.in_column[i] * (run.fy * (lower - upper));
    }
}

void copy(GraySamples& samples, std::size_t first, std::size_t count, const Greys& greys, const Pixels& pixels)
{
    const auto to = [&](std::vector<float>& values, const Values& from) {
        std::copy_n(from.begin(), count, values.begin() + static_cast<std::ptrdiff_t>(first));
    };
    to(samples.value, greys.value);
    to(samples.by_x, greys.by_x);
    to(samples.by_y, greys.by_y);
    to(samples.x, pixels.x);
    to(samples.y, pixels.y);
}

// Loops over a batch are plain, so that they become vector instructions; only what is loaded from anywhere is not.
void sample_run(GraySamples& samples, const RunSampler& sampler, const SampledTexels& sampled,
                const ObservationRun& run)
{
    Points points;
    Pixels pixels;
    Corners corners;
    Greys greys;
    for (std::size_t first = run.begin; first < run.end; first += kBatch) {
        const std::size_t count = std::min<std::size_t>(kBatch, run.end - first);
        const std::size_t padded = (count + kFloats - 1) / kFloats * kFloats;
        gather(points, sampled.texels, &sampled.observations.texel[first], count, padded);
        project(pixels, sampler, points, padded);
        fetch(corners, sampler.gray, pixels.offset, padded);
        interpolate(greys, sampler, pixels, corners, padded);
        copy(samples, first, count, greys, pixels);
    }
}

} // namespace

GraySamples sample_grays(const AlignmentScene& scene, const AlignmentState& state, const SampledTexels& sampled,
                         int level)
{
    const Camera camera = state.color.camera.at_level(level);
    GraySamples samples;
    for (auto* values : {&samples.value, &samples.by_x, &samples.by_y, &samples.x, &samples.y})
        values->resize(sampled.observations.size());
    parallel_for(scene.frames(), [&](std::size_t k) {
        const GrayImage& gray = scene.images[k].gray[static_cast<std::size_t>(level)];
        const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[k];
        for (std::uint32_t r = sampled.runs.first_of_frame[k]; r < sampled.runs.first_of_frame[k + 1]; ++r) {
            const ObservationRun& run = sampled.runs.run[r];
            sample_run(samples, run_sampler(gray, camera, color_from_world, state.plane[run.plane]), sampled, run);
        }
    });
    return samples;
}

std::vector<float> texel_colors(const Observations& observations, const std::vector<float>& gray, double delta,
                                int rounds)
{
    const std::size_t count = observations.first_of_texel.size() - 1;
    std::vector<float> color(count, 0.0f);
    const auto weighted_mean = [&](std::size_t t, bool robust) {
        double sum = 0.0, weight_sum = 0.0;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const double value = gray[observations.of_texel[i]];
            const double weight = robust ? huber_weight(value - color[t], delta) : 1.0;
            sum += weight * value;
            weight_sum += weight;
        }
        return weight_sum > 0.0 ? static_cast<float>(sum / weight_sum) : 0.0f;
    };
    parallel_for(
        count,
        [&](std::size_t t) {
            for (int round = 0; round <= rounds; ++round)
                color[t] = weighted_mean(t, round > 0);
        },
        kColorGrain);
    return color;
}

} // namespace quoin
