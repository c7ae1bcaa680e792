#include "alignment/channel_exposure.h"

#include "alignment/exposure.h"
#include "alignment/vignetting.h"
#include "base/parallel.h"
#include "image/sampling.h"

namespace quoin {
namespace {

constexpr float kWhite = 255.0f;

using Channels = std::array<std::vector<float>, 3>; // 0..1, of every observation

void sample_frame(Channels& channels, const ChannelSource& source, const AlignmentState& state,
                  const Observations& observations, std::size_t k)
{
    const ColorImage image = source.read.color(source.keyframes.frame[k]);
    const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[k];
    for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
        const TexelId t = observations.texel[o];
        const Vector3 p_world = state.plane[source.texels.plane[t]].project(source.texels.p_world[t].cast<double>());
        const Eigen::Vector2d pixel = state.color.camera.project(color_from_world * p_world);
        const Eigen::Vector3f color = sample_color(image, pixel.x(), pixel.y()) / kWhite;
        for (std::size_t c = 0; c < 3; ++c)
            channels[c][o] = color[static_cast<Eigen::Index>(c)];
    }
}

} // namespace

void set_channel_exposures(Alignment& alignment, const ChannelSource& source, const AlignmentState& state)
{
    const Observations& observations = source.observations;
    Channels channels;
    for (auto& channel : channels)
        channel.resize(observations.size());
    parallel_for(source.scene.frames(), [&](std::size_t k) {
        if (observations.first_of_frame[k] < observations.first_of_frame[k + 1])
            sample_frame(channels, source, state, observations, k);
    });
    const OptimizeTextureParams& params = source.scene.params;
    const auto radius = squared_radii(source.scene, state, source.texels, observations);
    if (params.optimize_vignetting)
        alignment.vignetting = estimate_vignetting(observations, radius, channels, state.exposure, params);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto exposure = estimate_exposures(observations, corrected(channels[c], radius, alignment.vignetting),
                                                 params, state.exposure);
        for (std::size_t k = 0; k < exposure.size(); ++k) {
            alignment.gain[k][static_cast<Eigen::Index>(c)] = static_cast<float>(exposure[k].gain);
            alignment.bias[k][static_cast<Eigen::Index>(c)] = static_cast<float>(exposure[k].bias) * kWhite;
        }
    }
}

} // namespace quoin
