#include "alignment/exposure.h"

#include "alignment/photometric.h"
#include "base/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

constexpr double kMinGain = 0.05; // a gain of zero would explain everything
constexpr int kExposureReweightings = 2;
constexpr std::size_t kWeighGrain = 4096;

// One channel of an observation and its robust weight.
struct WeightedView {
    std::uint32_t frame;
    float observed, weight;
};

// All observations by texel, and inside a texel by frame: view[i] is observation of_texel[i].
struct WeightedViews {
    const Observations& observations;
    std::vector<WeightedView> view;
    std::vector<std::uint32_t> place; // of every observation in `view`
    std::vector<float> texel_weight;  // of all views of a texel
};

WeightedViews weighted_views(const Observations& observations, const std::vector<float>& observed,
                             const std::vector<Exposure>& exposure, double huber)
{
    std::vector<float> corrected(observed.size());
    for (std::size_t o = 0; o < observed.size(); ++o) {
        const Exposure& e = exposure[observations.frame[o]];
        corrected[o] = static_cast<float>(e.gain * observed[o] + e.bias);
    }
    const auto color = texel_colors(observations, corrected, huber, kExposureReweightings);
    WeightedViews views{observations, std::vector<WeightedView>(observed.size()),
                        std::vector<std::uint32_t>(observed.size()), std::vector<float>(color.size(), 0.0f)};
    const auto weigh = [&](std::size_t t) {
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const std::uint32_t o = observations.of_texel[i];
            const auto weight = static_cast<float>(huber_weight(corrected[o] - color[t], huber));
            views.view[i] = {observations.frame[o], observed[o], weight};
            views.place[o] = i;
            views.texel_weight[t] += weight;
        }
    };
    parallel_for(color.size(), weigh, kWeighGrain);
    return views;
}

// Two columns of the normal matrix of sum w (v - mean v)^2 over all texels, v = gain I + bias: the lower half of those
// of frame k.
void add_frame(Eigen::MatrixXd& A, const WeightedViews& views, std::size_t k)
{
    const Observations& observations = views.observations;
    std::vector<Eigen::Array4d> with(observations.first_of_frame.size() - 1, Eigen::Array4d::Zero());
    for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
        const TexelId t = observations.texel[o];
        const std::uint32_t place = views.place[o];
        const double I = views.view[place].observed, weight = views.view[place].weight;
        with[k] += weight * Eigen::Array4d(I * I, I, I, 1.0);
        const Eigen::Array4d mine = weight / views.texel_weight[t] * Eigen::Array4d(I, I, 1.0, 1.0);
        for (std::uint32_t i = place; i < observations.first_of_texel[t + 1]; ++i) {
            const WeightedView& other = views.view[i];
            const double J = other.observed;
            with[other.frame] -= other.weight * (mine * Eigen::Array4d(J, 1.0, J, 1.0));
        }
    }
    auto columns = A.middleCols<2>(static_cast<Eigen::Index>(2 * k));
    for (std::size_t l = k; l < with.size(); ++l)
        columns.middleRows<2>(static_cast<Eigen::Index>(2 * l)) = Eigen::Map<const Eigen::Matrix2d>(with[l].data());
}

// Only relative exposures can be seen, and a darker picture has smaller differences: the means are held by equations
// that outweigh all others. The prior is per observation, so that it means the same in every frame.
Eigen::VectorXd add_prior_and_means(Eigen::MatrixXd& A, const WeightedViews& views, const OptimizeTextureParams& params)
{
    const auto frames = A.cols() / 2;
    const double hold = A.trace() / static_cast<double>(std::max<Eigen::Index>(1, frames));
    Eigen::VectorXd b = Eigen::VectorXd::Zero(A.cols());
    for (Eigen::Index k = 0; k < frames; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double count = views.observations.first_of_frame[i + 1] - views.observations.first_of_frame[i];
        const double least = 1e-9; // frames that see nothing still have an equation
        const double own = params.exposure_prior * std::max(1.0, count) + least;
        A(2 * k, 2 * k) += own;
        A(2 * k + 1, 2 * k + 1) += params.bias_prior * std::max(1.0, count) + least;
        b[2 * k] += own + hold;
        for (Eigen::Index l = 0; l < frames; ++l)
            for (const Eigen::Index row : {0, 1})
                A(2 * k + row, 2 * l + row) += hold / static_cast<double>(frames);
    }
    return b;
}

std::vector<Exposure> solve(const WeightedViews& views, const OptimizeTextureParams& params)
{
    const std::size_t frames = views.observations.first_of_frame.size() - 1;
    Eigen::MatrixXd A =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * frames), static_cast<Eigen::Index>(2 * frames));
    parallel_for(frames, [&](std::size_t k) { add_frame(A, views, k); });
    const Eigen::VectorXd b = add_prior_and_means(A, views, params);
    const Eigen::LLT<Eigen::MatrixXd> factor = A.selfadjointView<Eigen::Lower>().llt();
    if (factor.info() != Eigen::Success) return std::vector<Exposure>(frames);
    const Eigen::VectorXd x = factor.solve(b);
    std::vector<Exposure> exposure(frames);
    for (std::size_t k = 0; k < frames && x.allFinite(); ++k)
        exposure[k] = {std::max(x[static_cast<Eigen::Index>(2 * k)], kMinGain),
                       x[static_cast<Eigen::Index>(2 * k + 1)]};
    return exposure;
}

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
    if (observations.size() == 0) return exposure;
    for (int round = 0; round < params.exposure_rounds; ++round) {
        exposure = solve(weighted_views(observations, observed, exposure, params.huber_color), params);
        normalize(exposure);
    }
    return exposure;
}

} // namespace quoin
