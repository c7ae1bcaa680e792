#include "lines/edge_points.h"

#include "image/sampling.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

// One row a place; the line itself crosses column `centre`.
struct Profiles {
    int width = 0, centre = 0;
    std::vector<float> value;

    Profiles(int places, int reach)
        : width(2 * reach + 1), centre(reach),
          value(static_cast<std::size_t>(places) * static_cast<std::size_t>(width), 0.0f)
    {
    }
    float* row(int place) { return value.data() + static_cast<std::size_t>(place) * static_cast<std::size_t>(width); }
    const float* row(int place) const
    {
        return value.data() + static_cast<std::size_t>(place) * static_cast<std::size_t>(width);
    }
};

// Derivative of a Gaussian; its answer to a ramp of 1 a px is 1.
std::vector<float> derivative_kernel(double sigma)
{
    const int radius = std::max(1, static_cast<int>(std::ceil(3.0 * sigma)));
    std::vector<float> kernel;
    double ramp = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        const double weight = i * std::exp(-0.5 * i * i / (sigma * sigma));
        kernel.push_back(static_cast<float>(weight));
        ramp += i * weight;
    }
    for (float& weight : kernel)
        weight = static_cast<float>(weight / ramp);
    return kernel;
}

constexpr float kGreyLevels = 255.0f;

bool has_neighbours(const GrayImage& image, const Eigen::Vector2d& u)
{
    return u.x() >= 0.0 && u.y() >= 0.0 && u.x() < image.width - 1 && u.y() < image.height - 1;
}

float sampled(const GrayImage& image, const Eigen::Vector2d& u)
{
    return kGreyLevels * sample_gray(image, u.x(), u.y()).value;
}

// Beyond the image's border the last value repeats and has no gradient.
void sample_profile(const GrayImage& image, const Eigen::Vector2d& place, const Eigen::Vector2d& across, int reach,
                    float* centre)
{
    if (has_neighbours(image, place - reach * across) && has_neighbours(image, place + reach * across)) {
        for (int i = -reach; i <= reach; ++i)
            centre[i] = sampled(image, place + i * across);
        return;
    }
    for (const int side : {-1, 1})
        for (int i = 0; i <= reach; ++i) {
            const Eigen::Vector2d u = place + side * i * across;
            const float last = i > 0 ? centre[side * (i - 1)] : 0.0f;
            centre[side * i] = has_neighbours(image, u) ? sampled(image, u) : last;
        }
}

Profiles sample_profiles(const GrayImage& image, const Strip& strip, int reach)
{
    Profiles profiles(strip.places, reach);
    for (int i = 0; i < strip.places; ++i)
        sample_profile(image, strip.start + i * strip.step * strip.along, strip.across, reach,
                       profiles.row(i) + profiles.centre);
    return profiles;
}

// Each place takes half of its value from its neighbours: noise falls, an edge along the line stays.
Profiles smooth_along(const Profiles& in, int places)
{
    Profiles out(places, in.centre);
    for (int i = 0; i < places; ++i) {
        const float *before = in.row(std::max(0, i - 1)), *here = in.row(i),
                    *after = in.row(std::min(places - 1, i + 1));
        float* row = out.row(i);
        for (int k = 0; k < in.width; ++k)
            row[k] = 0.25f * before[k] + 0.5f * here[k] + 0.25f * after[k];
    }
    return out;
}

Profiles derive_across(const Profiles& in, int places, const std::vector<float>& kernel)
{
    const int radius = static_cast<int>(kernel.size() / 2);
    Profiles out(places, in.centre - radius);
    for (int i = 0; i < places; ++i)
        for (std::size_t j = 0; j < kernel.size(); ++j) {
            const float* value = in.row(i) + j;
            float* row = out.row(i);
            for (int k = 0; k < out.width; ++k)
                row[k] += kernel[j] * value[k];
        }
    return out;
}

// Vertex of the parabola through three equidistant values of which the middle one is the largest.
float peak_between(float left, float middle, float right)
{
    const float bend = left - 2.0f * middle + right;
    return bend < 0.0f ? 0.5f * (left - right) / bend : 0.0f;
}

} // namespace

Strip strip_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const DetectLinesParams& params)
{
    const double length = (b - a).norm();
    const int steps = std::max(1, static_cast<int>(std::lround(length / params.guided_step)));
    const Eigen::Vector2d along = (b - a) / length;
    return {a, along, {-along.y(), along.x()}, length / steps, steps + 1};
}

std::vector<EdgePoint> edge_points(const GrayImage& image, const Strip& strip, const DetectLinesParams& params)
{
    const auto kernel = derivative_kernel(params.guided_sigma);
    const int margin = static_cast<int>(kernel.size() / 2) + 1; // one more, to see that a maximum is one
    const Profiles values = sample_profiles(image, strip, params.guided_reach + margin);
    const Profiles gradients = derive_across(smooth_along(values, strip.places), strip.places, kernel);
    const auto least = static_cast<float>(params.guided_gradient);
    std::vector<EdgePoint> points;
    for (int i = 0; i < strip.places; ++i) {
        const float* g = gradients.row(i);
        for (int k = 1; k + 1 < gradients.width; ++k) {
            if (std::abs(g[k]) < least) continue;
            const float sign = g[k] > 0.0f ? 1.0f : -1.0f;
            const float left = sign * g[k - 1], here = sign * g[k], right = sign * g[k + 1];
            if (here <= left || here < right) continue;
            points.push_back({i, static_cast<float>(k - gradients.centre) + peak_between(left, here, right), g[k]});
        }
    }
    return points;
}

} // namespace quoin
