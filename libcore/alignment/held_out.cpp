#include "alignment/held_out.h"

#include "alignment/exposure.h"
#include "alignment/photometric.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

constexpr int kSquare =
    4; // finest texels along a square's side: small, so that no plane goes without all of its texels
constexpr int kColorRounds = 3;
constexpr double kGrayLevels = 255.0;

// Bits as good as random (the finaliser of MurmurHash3).
std::uint32_t mixed(std::uint32_t h)
{
    h = (h ^ (h >> 16)) * 0x85EBCA6Bu;
    h = (h ^ (h >> 13)) * 0xC2B2AE35u;
    return h ^ (h >> 16);
}

// 0..1, of a square of a plane.
double lot(PlaneId plane, int column, int row)
{
    const std::uint32_t h =
        mixed(mixed(mixed(plane + 1u) ^ static_cast<std::uint32_t>(column)) + static_cast<std::uint32_t>(row));
    return std::ldexp(static_cast<double>(h), -32);
}

struct Views {
    const Texels& texels;
    Observations observations;
    ObservationRuns runs;
    std::vector<std::uint8_t> is_held_out; // of every texel
};

// Of every texel, its views' summed robust squares of the differences to its colour; estimates the exposures.
std::vector<double> texel_costs(const AlignmentScene& scene, const Views& views, AlignmentState& state)
{
    const OptimizeTextureParams& params = scene.params;
    const auto observed = sample_grays(scene, state, {views.texels, views.observations, views.runs}, 0).value;
    if (params.optimize_exposure)
        state.exposure = estimate_exposures(views.observations, observed, params, std::move(state.exposure));
    const auto gray = exposed(views.observations, observed, state.exposure);
    const auto color = texel_colors(views.observations, gray, params.huber_color, kColorRounds);
    std::vector<double> cost(views.texels.size(), 0.0);
    for (std::size_t o = 0; o < gray.size(); ++o) {
        const TexelId t = views.observations.texel[o];
        cost[t] += huber_cost(static_cast<double>(gray[o] - color[t]), params.huber_color);
    }
    return cost;
}

// Both costs are of the same views: texels are the independent samples of their difference.
std::optional<HeldOutScores> compared(const Views& views, const std::vector<double>& input,
                                      const std::vector<double>& optimized, double certainty)
{
    double before = 0.0, after = 0.0, squares = 0.0, count = 0.0;
    for (TexelId t = 0; t < input.size(); ++t) {
        if (!views.is_held_out[t] || views.observations.views(t) == 0) continue;
        before += input[t];
        after += optimized[t];
        squares += (optimized[t] - input[t]) * (optimized[t] - input[t]);
        count += views.observations.views(t);
    }
    if (count == 0.0) return std::nullopt;
    const auto level = [&](double sum) { return kGrayLevels * std::sqrt(sum / count); };
    return HeldOutScores{level(before), level(after), after - before > certainty * std::sqrt(squares)};
}

} // namespace

std::vector<std::uint8_t> held_out_texels(const Texels& texels, const OptimizeTextureParams& params)
{
    const double side = kSquare * params.texel_size * params.texel_stride; // [m]
    const auto square = [&](int cell) { return static_cast<int>(std::floor(cell * (texels.spacing / side))); };
    std::vector<std::uint8_t> is_held_out(texels.size());
    for (TexelId t = 0; t < texels.size(); ++t) {
        const auto& [column, row] = texels.cell[t];
        is_held_out[t] = lot(texels.plane[t], square(column), square(row)) < params.held_out;
    }
    return is_held_out;
}

std::optional<HeldOutScores> judge(const AlignmentScene& scene, const Texels& texels, const SeenState& input,
                                   const SeenState& optimized)
{
    if (scene.params.held_out == 0.0) return std::nullopt;
    Views views{texels, in_both(input.observations, optimized.observations), {}, held_out_texels(texels, scene.params)};
    views.runs = runs_of(views.observations, texels);
    const auto before = texel_costs(scene, views, input.state), after = texel_costs(scene, views, optimized.state);
    return compared(views, before, after, scene.params.certainty);
}

} // namespace quoin
