#include "alignment/exposure.h"

#include "alignment/photometric.h"
#include "base/lanes.h"
#include "base/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace quoin {
namespace {

constexpr double kMinGain = 0.05; // a gain of zero would explain everything
constexpr int kExposureReweightings = 2;
constexpr std::size_t kWeighGrain = 4096;
constexpr double kSettled = 1e-4; // gains and biases that change less are not estimated again

// One channel of an observation, times its robust weight, and the weight.
struct WeightedView {
    std::uint32_t frame;
    float weighted, weight;
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
    const auto gray = exposed(observations, observed, exposure);
    const auto color = texel_colors(observations, gray, huber, kExposureReweightings);
    WeightedViews views{observations, std::vector<WeightedView>(observed.size()),
                        std::vector<std::uint32_t>(observed.size()), std::vector<float>(color.size(), 0.0f)};
    const auto weigh = [&](std::size_t t) {
        for (std::uint32_t i = observations.first_of_texel[t]; i < observations.first_of_texel[t + 1]; ++i) {
            const std::uint32_t o = observations.of_texel[i];
            const auto weight = static_cast<float>(huber_weight(gray[o] - color[t], huber));
            views.view[i] = {observations.frame[o], weight * observed[o], weight};
            views.place[o] = i;
            views.texel_weight[t] += weight;
        }
    };
    parallel_for(color.size(), weigh, kWeighGrain);
    return views;
}

using Quad = float __attribute__((vector_size(16)));

// (weighted, weight) of a view, twice: one instruction loads them.
Quad twice(const WeightedView& view)
{
    using Pair = double __attribute__((vector_size(16)));
    double both;
    std::memcpy(&both, &view.weighted, sizeof both);
    return reinterpret_cast<Quad>(Pair{both, both});
}

// Two columns of the normal matrix of sum w (v - mean v)^2 over all texels, v = gain I + bias: the lower half of those
// of frame k.
void add_frame(Eigen::MatrixXd& A, const WeightedViews& views, const std::vector<float>& observed, std::size_t k)
{
    const Observations& observations = views.observations;
    std::vector<Doubles> with(observations.first_of_frame.size() - 1, Doubles{});
    for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
        const TexelId t = observations.texel[o];
        const std::uint32_t place = views.place[o];
        const double I = observed[o], weight = views.view[place].weight;
        with[k] += weight * Doubles{I * I, I, I, 1.0};
        const float part = views.view[place].weight / views.texel_weight[t], mine = part * observed[o];
        const Quad by_mine{mine, mine, part, part};
        for (std::uint32_t i = place; i < observations.first_of_texel[t + 1]; ++i)
            with[views.view[i].frame] -= __builtin_convertvector(by_mine * twice(views.view[i]), Doubles);
    }
    auto columns = A.middleCols<2>(static_cast<Eigen::Index>(2 * k));
    for (std::size_t l = k; l < with.size(); ++l)
        columns.middleRows<2>(static_cast<Eigen::Index>(2 * l)) << with[l][0], with[l][2], with[l][1], with[l][3];
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

std::vector<Exposure> solve(const WeightedViews& views, const std::vector<float>& observed,
                            const OptimizeTextureParams& params)
{
    const std::size_t frames = views.observations.first_of_frame.size() - 1;
    Eigen::MatrixXd A =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * frames), static_cast<Eigen::Index>(2 * frames));
    parallel_for(frames, [&](std::size_t k) { add_frame(A, views, observed, k); });
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

bool has_settled(const std::vector<Exposure>& before, const std::vector<Exposure>& after)
{
    return std::ranges::equal(before, after, [](const Exposure& a, const Exposure& b) {
        return std::abs(a.gain - b.gain) < kSettled && std::abs(a.bias - b.bias) < kSettled;
    });
}

} // namespace

std::vector<Exposure> estimate_exposures(const Observations& observations, const std::vector<float>& observed,
                                         const OptimizeTextureParams& params, std::vector<Exposure> start)
{
    if (observations.size() == 0) return std::vector<Exposure>(start.size());
    for (int round = 0; round < params.exposure_rounds; ++round) {
        auto exposure = solve(weighted_views(observations, observed, start, params.huber_color), observed, params);
        normalize(exposure);
        std::swap(start, exposure);
        if (has_settled(exposure, start)) break;
    }
    return start;
}

std::vector<float> exposed(const Observations& observations, const std::vector<float>& observed,
                           const std::vector<Exposure>& exposure)
{
    std::vector<float> gray(observed.size());
    parallel_for(exposure.size(), [&](std::size_t k) {
        const auto gain = static_cast<float>(exposure[k].gain), bias = static_cast<float>(exposure[k].bias);
        for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o)
            gray[o] = gain * observed[o] + bias;
    });
    return gray;
}

} // namespace quoin
