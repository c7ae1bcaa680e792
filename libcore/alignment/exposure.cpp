#include "alignment/exposure.h"

#include "alignment/photometric.h"
#include "base/parallel.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

constexpr double kMinGain = 0.05; // a gain of zero would explain everything
constexpr int kReweightings = 2;

std::vector<float> corrected(const Observations& observations, const std::vector<float>& observed,
                             const std::vector<Exposure>& exposure)
{
    std::vector<float> result(observed.size());
    for (std::size_t o = 0; o < observed.size(); ++o) {
        const Exposure& e = exposure[observations.frame[o]];
        result[o] = static_cast<float>(e.gain * observed[o] + e.bias);
    }
    return result;
}

// min over (g, b) of sum w (g I + b - C)^2 + prior count ((g - 1)^2 + b^2).
Exposure fit_frame(const Observations& observations, const std::vector<float>& observed,
                   const std::vector<float>& color, std::size_t k, const Exposure& current,
                   const OptimizeTextureParams& params)
{
    const std::uint32_t begin = observations.first_of_frame[k], end = observations.first_of_frame[k + 1];
    if (begin == end) return {};
    const double prior = params.exposure_prior * (end - begin);
    Eigen::Matrix2d A = prior * Eigen::Matrix2d::Identity();
    Eigen::Vector2d b(prior, 0.0);
    for (std::uint32_t o = begin; o < end; ++o) {
        const double I = observed[o], C = color[observations.texel[o]];
        const double weight = huber_weight(current.gain * I + current.bias - C, params.huber_color);
        A += weight * (Eigen::Matrix2d() << I * I, I, I, 1.0).finished();
        b += weight * C * Eigen::Vector2d(I, 1.0);
    }
    const Eigen::Vector2d x = A.inverse() * b;
    return x.allFinite() ? Exposure{std::max(x[0], kMinGain), x[1]} : current;
}

// Only relative exposures can be seen: the overall one is fixed by the mean log gain and the mean bias.
void normalize(std::vector<Exposure>& exposure)
{
    double log_gain = 0.0, bias = 0.0;
    for (const Exposure& e : exposure)
        log_gain += std::log(e.gain) / static_cast<double>(exposure.size());
    for (Exposure& e : exposure) {
        e.gain *= std::exp(-log_gain);
        e.bias *= std::exp(-log_gain);
        bias += e.bias / static_cast<double>(exposure.size());
    }
    for (Exposure& e : exposure)
        e.bias -= bias;
}

} // namespace

std::vector<Exposure> estimate_exposures(const Observations& observations, const std::vector<float>& observed,
                                         const OptimizeTextureParams& params)
{
    std::vector<Exposure> exposure(observations.first_of_frame.size() - 1);
    for (int round = 0; round < params.exposure_rounds; ++round) {
        const auto color =
            texel_colors(observations, corrected(observations, observed, exposure), params.huber_color, kReweightings);
        parallel_for(exposure.size(), [&](std::size_t k) {
            exposure[k] = fit_frame(observations, observed, color, k, exposure[k], params);
        });
        normalize(exposure);
    }
    return exposure;
}

} // namespace quoin
