#include "alignment/vignetting.h"

#include "alignment/exposure.h"
#include "alignment/photometric.h"
#include "base/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

namespace quoin {
namespace {

constexpr int kRounds = 4;                // of exposures and vignetting in turn: they hardly depend
constexpr int kReweightings = 2;          // of the texels' colours
constexpr std::size_t kTexelGrain = 4096; // [texels]
constexpr double kPrior = 1e-6;           // pull of k to 0, per observation: all frames tell of one lens
constexpr double kMostCorrection = 4.0;   // in the corners; no lens blacks them out

// Normal equations of k in sum w (v - mean v)^2, v = gain I (1 + k . (r^2, r^4, r^6)) + bias.
struct Equations {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();

    friend Equations operator+(const Equations& x, const Equations& y) { return {x.A + y.A, x.b + y.b}; }
};

// One channel with the exposures of all frames.
struct ExposedChannel {
    const Observations& observations;
    const std::vector<float>& squared_radius;
    const std::vector<float>& observed;
    const std::vector<Exposure>& exposure;
    const Vignetting& vignetting;

    double without_vignetting_term(std::uint32_t o) const // gain I + bias
    {
        const Exposure& e = exposure[observations.frame[o]];
        return e.gain * observed[o] + e.bias;
    }
    Eigen::Vector3d by_k(std::uint32_t o) const
    {
        const double r2 = squared_radius[o];
        return exposure[observations.frame[o]].gain * observed[o] * Eigen::Vector3d(r2, r2 * r2, r2 * r2 * r2);
    }
    float value(std::uint32_t o) const
    {
        return static_cast<float>(without_vignetting_term(o) + by_k(o).dot(vignetting.k.cast<double>()));
    }
};

Equations equations_of_texel(const ExposedChannel& channel, TexelId t, float color, double huber)
{
    Equations result;
    Eigen::Vector3d mean_row = Eigen::Vector3d::Zero();
    double mean_value = 0.0, weights = 0.0;
    for (std::uint32_t i = channel.observations.first_of_texel[t]; i < channel.observations.first_of_texel[t + 1];
         ++i) {
        const std::uint32_t o = channel.observations.of_texel[i];
        const double w = huber_weight(channel.value(o) - color, huber);
        const Eigen::Vector3d row = channel.by_k(o);
        const double value = channel.without_vignetting_term(o);
        result.A += w * row * row.transpose();
        result.b -= w * value * row;
        mean_row += w * row;
        mean_value += w * value;
        weights += w;
    }
    if (weights > 0.0) {
        result.A -= mean_row * mean_row.transpose() / weights;
        result.b += mean_value / weights * mean_row;
    }
    return result;
}

Equations equations_of(const ExposedChannel& channel, double huber)
{
    std::vector<float> value(channel.observed.size());
    parallel_for(
        value.size(), [&](std::size_t o) { value[o] = channel.value(static_cast<std::uint32_t>(o)); }, kTexelGrain);
    const auto color = texel_colors(channel.observations, value, huber, kReweightings);
    return parallel_reduce(
        color.size(), kTexelGrain, Equations{},
        [&](std::size_t begin, std::size_t end) {
            Equations sum;
            for (std::size_t t = begin; t < end; ++t)
                sum = sum + equations_of_texel(channel, static_cast<TexelId>(t), color[t], huber);
            return sum;
        },
        std::plus<>());
}

// The solution without negative numbers: a lens loses light towards the corners and nowhere gains any. Of eight sets of
// unknowns that may be other than 0, the best of those that come out positive.
Eigen::Vector3d solve_non_negative(const Equations& equations)
{
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double least = 0.0; // of k A k / 2 - b k
    for (unsigned set = 1; set < 8; ++set) {
        Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
        Eigen::Vector3d b = Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i) {
            if ((set >> i & 1u) == 0) continue;
            b[i] = equations.b[i];
            for (int j = 0; j < 3; ++j)
                if ((set >> j & 1u) != 0) A(i, j) = equations.A(i, j);
        }
        const Eigen::Vector3d k = A.ldlt().solve(b);
        const double value = 0.5 * k.dot(equations.A * k) - equations.b.dot(k);
        if (!k.allFinite() || k.minCoeff() < 0.0 || value >= least) continue;
        least = value;
        best = k;
    }
    return best;
}

} // namespace

std::vector<float> squared_radii(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels,
                                 const Observations& observations)
{
    std::vector<float> radius(observations.size());
    const Camera& camera = state.color.camera;
    parallel_for(scene.frames(), [&](std::size_t k) {
        const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[k];
        for (std::uint32_t o = observations.first_of_frame[k]; o < observations.first_of_frame[k + 1]; ++o) {
            const TexelId t = observations.texel[o];
            const Vector3 p_world = state.plane[texels.plane[t]].project(texels.p_world[t].cast<double>());
            const Eigen::Vector2d pixel = camera.project(color_from_world * p_world);
            radius[o] = static_cast<float>(Vignetting::squared_radius(camera.width, camera.height, pixel));
        }
    });
    return radius;
}

Vignetting estimate_vignetting(const Observations& observations, const std::vector<float>& squared_radius,
                               std::span<const std::vector<float>> channels, const std::vector<Exposure>& start,
                               const OptimizeTextureParams& params)
{
    Vignetting vignetting;
    if (observations.size() == 0) return vignetting;
    std::vector<std::vector<Exposure>> exposure(channels.size(), start);
    for (int round = 0; round < kRounds; ++round) {
        Equations sum;
        for (std::size_t c = 0; c < channels.size(); ++c) {
            exposure[c] = estimate_exposures(observations, corrected(channels[c], squared_radius, vignetting), params,
                                             std::move(exposure[c]));
            sum = sum + equations_of({observations, squared_radius, channels[c], exposure[c], vignetting},
                                     params.huber_color);
        }
        const double prior = kPrior * static_cast<double>(channels.size() * observations.size());
        sum.A.diagonal().array() += prior;
        vignetting.k = solve_non_negative(sum).cast<float>();
        if (vignetting.correction(1.0) > kMostCorrection) return {};
    }
    return vignetting;
}

void correct(AlignmentScene& scene, const Vignetting& vignetting)
{
    parallel_for(scene.frames(), [&](std::size_t k) {
        for (CornerImage& image : scene.images[k].gray) {
            GrayImage gray = image.gray();
            for (int y = 0; y < gray.height; ++y)
                for (int x = 0; x < gray.width; ++x)
                    gray.at(x, y) *= static_cast<float>(
                        vignetting.correction(Vignetting::squared_radius(gray.width, gray.height, {x, y})));
            image = gray;
        }
    });
}

std::vector<float> corrected(const std::vector<float>& observed, const std::vector<float>& squared_radius,
                             const Vignetting& vignetting)
{
    std::vector<float> result(observed.size());
    for (std::size_t o = 0; o < observed.size(); ++o)
        result[o] = observed[o] * static_cast<float>(vignetting.correction(squared_radius[o]));
    return result;
}

} // namespace quoin
