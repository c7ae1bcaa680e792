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

// Observations of a run that are sampled together.
struct Batch {
    std::size_t first = 0, count = 0;
    std::size_t padded() const { return (count + kFloats - 1) / kFloats * kFloats; }
};

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
void gather(Points& points, const Texels& texels, const TexelId* texel, const Batch& batch)
{
    for (std::size_t i = 0; i < batch.padded(); ++i) {
        const Eigen::Vector3f& p = texels.p_world[texel[std::min(i, batch.count - 1)]];
        points.x[i] = p.x();
        points.y[i] = p.y();
        points.z[i] = p.z();
    }
}

Floats each(float value) { return Floats{} + value; }

void project(Pixels& pixels, const RunSampler& run, const Points& points, std::size_t padded)
{
    const Eigen::Matrix<float, 3, 4> A = run.color_from_point;
    const Floats zero{}, one = each(1.0f), nearest = each(kMinDepth);
    const Floats x_max = each(static_cast<float>(run.gray.width) - 1.001f);
    const Floats y_max = each(static_cast<float>(run.gray.height) - 1.001f);
    for (std::size_t i = 0; i < padded; i += kFloats) {
        const Floats p = load(&points.x[i]), q = load(&points.y[i]), r = load(&points.z[i]);
        const Floats X = A(0, 0) * p + A(0, 1) * q + A(0, 2) * r + A(0, 3);
        const Floats Y = A(1, 0) * p + A(1, 1) * q + A(1, 2) * r + A(1, 3);
        const Floats Z = A(2, 0) * p + A(2, 1) * q + A(2, 2) * r + A(2, 3);
        const Floats inverse = 1.0f / (Z >= nearest ? Z : nearest);
        const Floats u = run.fx * (X * inverse) + run.cx, v = run.fy * (Y * inverse) + run.cy;
        const Floats not_right = u < x_max ? u : x_max, not_below = v < y_max ? v : y_max;
        const Floats column = not_right > zero ? not_right : zero, row = not_below > zero ? not_below : zero;
        const Ints x0 = __builtin_convertvector(column, Ints), y0 = __builtin_convertvector(row, Ints);
        store(X * inverse, &pixels.x[i]);
        store(Y * inverse, &pixels.y[i]);
        store(Z >= nearest ? one : zero, &pixels.seen[i]);
        store(column == u ? one : zero, &pixels.in_row[i]);
        store(row == v ? one : zero, &pixels.in_column[i]);
        store(column - __builtin_convertvector(x0, Floats), &pixels.along[i]);
        store(row - __builtin_convertvector(y0, Floats), &pixels.down[i]);
        store(y0 * run.gray.width + x0, &pixels.offset[i]);
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

// The bilinear surface and its exact derivative.
void interpolate(GraySamples& samples, const Batch& batch, const RunSampler& run, const Pixels& pixels,
                 const Corners& corners)
{
    for (std::size_t i = 0; i < batch.count; i += kFloats) {
        const Floats left = load(&corners.left[i]), lower_left = load(&corners.lower_left[i]);
        const Floats along = load(&pixels.along[i]), down = load(&pixels.down[i]), seen = load(&pixels.seen[i]);
        const Floats slope_upper = load(&corners.right[i]) - left;
        const Floats slope_lower = load(&corners.lower_right[i]) - lower_left;
        const Floats upper = left + along * slope_upper, lower = lower_left + along * slope_lower;
        const Floats slope = slope_upper + down * (slope_lower - slope_upper);
        const std::size_t o = batch.first + i, n = batch.count - i;
        store_part(seen * (upper + down * (lower - upper)), &samples.value[o], n);
        store_part(seen * load(&pixels.in_row[i]) * (run.fx * slope), &samples.by_x[o], n);
        store_part(seen * load(&pixels.in_column[i]) * (run.fy * (lower - upper)), &samples.by_y[o], n);
        store_part(load(&pixels.x[i]), &samples.x[o], n);
        store_part(load(&pixels.y[i]), &samples.y[o], n);
    }
}

// All is done in lanes but for what is loaded from anywhere.
void sample_run(GraySamples& samples, const RunSampler& sampler, const SampledTexels& sampled,
                const ObservationRun& run)
{
    Points points;
    Pixels pixels;
    Corners corners;
    for (std::size_t first = run.begin; first < run.end; first += kBatch) {
        const Batch batch{first, std::min<std::size_t>(kBatch, run.end - first)};
        gather(points, sampled.texels, &sampled.observations.texel[first], batch);
        project(pixels, sampler, points, batch.padded());
        fetch(corners, sampler.gray, pixels.offset, batch.padded());
        interpolate(samples, batch, sampler, pixels, corners);
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
