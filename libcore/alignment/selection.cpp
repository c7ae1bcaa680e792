#include "alignment/selection.h"

#include "alignment/photometric.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace quoin {
namespace {

constexpr std::size_t kGradientGrain = 1024;

// The mean length of the image gradient where the frames see a texel, for each texel.
std::vector<float> mean_gradients(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                  const Observations& observations, int level)
{
    const Camera camera = state.color.camera.at_level(level);
    const auto per_x = static_cast<float>(1.0 / camera.fx), per_y = static_cast<float>(1.0 / camera.fy);
    const GraySamples samples =
        sample_grays(scene, state, {texels, observations, runs_of(observations, texels)}, level);
    const auto mean_of = [&](std::size_t t) {
        const std::uint32_t views = observations.views(static_cast<TexelId>(t));
        float sum = 0.0f;
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const std::uint32_t o = observations.of_texel[i];
            const float gx = per_x * samples.by_x[o], gy = per_y * samples.by_y[o];
            sum += std::sqrt(gx * gx + gy * gy);
        }
        return views > 0 ? sum / static_cast<float>(views) : 0.0f;
    };
    std::vector<float> mean(texels.size());
    parallel_for(
        mean.size(), [&](std::size_t t) { mean[t] = mean_of(t); }, kGradientGrain);
    return mean;
}

} // namespace

std::vector<std::uint8_t> select_texels(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                        const Observations& observations, int level)
{
    const OptimizeTextureParams& params = scene.params;
    const std::vector<float> gradient = mean_gradients(scene, state, texels, observations, level);
    const auto bucket_of = [&](TexelId t) {
        const auto floor_div = [&](int a) { return (a >= 0 ? a : a - params.bucket + 1) / params.bucket; };
        return std::tuple(texels.plane[t], floor_div(texels.cell[t][1]), floor_div(texels.cell[t][0]));
    };
    std::vector<TexelId> order;
    for (TexelId t = 0; t < texels.size(); ++t)
        if (observations.views(t) >= 2) order.push_back(t);
    std::ranges::sort(order, {}, [&](TexelId t) { return std::tuple(bucket_of(t), -gradient[t], t); });

    std::vector<std::uint8_t> keep(texels.size(), 0);
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && bucket_of(order[end]) == bucket_of(order[begin]))
            ++end;
        const auto best =
            begin + static_cast<std::size_t>(std::ceil(params.selected * static_cast<double>(end - begin)));
        for (std::size_t i = begin; i < best && gradient[order[i]] >= params.min_gradient; ++i)
            keep[order[i]] = 1;
    }
    const auto every =
        params.uniform > 0.0 ? static_cast<std::size_t>(std::ceil(1.0 / params.uniform)) : order.size() + 1;
    for (std::size_t i = every - 1; i < order.size(); i += every)
        keep[order[i]] = 1;
    return keep;
}

Textured textured_texels(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                         const Observations& observations)
{
    const std::vector<float> gradient = mean_gradients(scene, state, texels, observations, 0);
    Textured result;
    for (TexelId t = 0; t < texels.size(); ++t) {
        if (observations.views(t) < 2) continue;
        ++result.seen;
        if (gradient[t] >= scene.params.min_gradient) ++result.textured;
    }
    return result;
}

} // namespace quoin
