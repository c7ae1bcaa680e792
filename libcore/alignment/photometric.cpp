#include "alignment/photometric.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace quoin {
namespace {

constexpr float kMinDepth = 1e-3f; // [m]; points nearer to the camera plane have no pixel
constexpr float kInside = 1.001f;    // [px] from the size of an image to the last place with four corners
constexpr std::size_t kColorGrain = 4096;

// The picture of a frame at a level, and its camera.
struct FramePicture {
    const CornerImage& gray;
    float fx, fy, cx, cy, x_max, y_max;

    FramePicture(const CornerImage& gray_, const Camera& camera)
        : gray(gray_), fx(static_cast<float>(camera.fx)), fy(static_cast<float>(camera.fy)),
          cx(static_cast<float>(camera.cx)), cy(static_cast<float>(camera.cy)),
          x_max(static_cast<float>(gray.width()) - kInside), y_max(static_cast<float>(gray.height()) - kInside)
    {
    }
};

using Projection = Eigen::Matrix<float, 3, 4>; // from points, by way of their plane, to the colour camera

Floats clamped(const Floats& value, float most)
{
    const Floats low = value < most ? value : each(most);
    return low > 0.0f ? low : Floats{};
}

// Samples the first eight of `count` observations from `o` on: the bilinear surface and its exact derivative.
[[gnu::always_inline]] inline void sample_lanes(GraySamples& samples, const FramePicture& picture,
                                                const Projection& color_from_point, const SampledTexels& sampled,
                                                std::size_t o, std::size_t count)
{
    const Projection& A = color_from_point;
    const Ints point = 3 * load_part(&sampled.observations.texel[o], count); // past the end, the first texel
    const float* points = sampled.texels.p_world.front().data();
    const Floats p = gather(points, point), q = gather(points + 1, point), r = gather(points + 2, point);
    const Floats X = A(0, 0) * p + A(0, 1) * q + A(0, 2) * r + A(0, 3);
    const Floats Y = A(1, 0) * p + A(1, 1) * q + A(1, 2) * r + A(1, 3);
    const Floats Z = A(2, 0) * p + A(2, 1) * q + A(2, 2) * r + A(2, 3);
    const Floats inverse = 1.0f / (Z >= kMinDepth ? Z : each(kMinDepth));
    const Floats x = X * inverse, y = Y * inverse;
    const Floats u = picture.fx * x + picture.cx, v = picture.fy * y + picture.cy;
    const Floats column = clamped(u, picture.x_max), row = clamped(v, picture.y_max);
    const CornerImage::Samples gray = picture.gray.sample(column, row);
    const Ints seen = Z >= kMinDepth;
    store_part(seen ? gray.value : Floats{}, &samples.value[o], count);
    store_part((seen & (column == u)) ? picture.fx * gray.by_u : Floats{}, &samples.by_x[o], count);
    store_part((seen & (row == v)) ? picture.fy * gray.by_v : Floats{}, &samples.by_y[o], count);
    store_part(x, &samples.x[o], count);
    store_part(y, &samples.y[o], count);
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
        const FramePicture picture(scene.images[k].gray[static_cast<std::size_t>(level)], camera);
        const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[k];
        for (std::uint32_t r = sampled.runs.first_of_frame[k]; r < sampled.runs.first_of_frame[k + 1]; ++r) {
            const ObservationRun& run = sampled.runs.run[r];
            const Projection color_from_point =
                (color_from_world * state.plane[run.plane].projection()).matrix().topRows<3>().cast<float>();
            for (std::size_t o = run.begin; o < run.end; o += kFloats)
                sample_lanes(samples, picture, color_from_point, sampled, o, run.end - o);
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
