#include "image/sampling.h"

#include <algorithm>
#include <cstring>

namespace quoin {
namespace {

// Of the pixels from the one before on, for a point `t` behind a pixel, 0..1.
std::array<float, 4> cubic_weights(float t)
{
    constexpr float a = -0.75f; // slope of the kernel at a distance of 1; -0.5 blurs more, -1 swings over more
    const float s = 1.0f - t;
    return {a * t * s * s, ((a + 2) * t - (a + 3)) * t * t + 1, ((a + 2) * s - (a + 3)) * s * s + 1, a * s * t * t};
}

std::vector<float> gaussian_kernel(double sigma)
{
    const int radius = std::max(1, static_cast<int>(std::ceil(3.0 * sigma)));
    std::vector<float> kernel(static_cast<std::size_t>(2 * radius + 1));
    double sum = 0.0;
    for (int i = -radius; i <= radius; ++i)
        sum += kernel[static_cast<std::size_t>(i + radius)] =
            static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)));
    for (auto& weight : kernel)
        weight = static_cast<float>(weight / sum);
    return kernel;
}

} // namespace

GrayImage to_gray(const ColorImage& color)
{
    GrayImage gray(color.width, color.height);
    std::ranges::transform(color.pixels, gray.pixels.begin(), [](const Rgb8& p) {
        return (0.299f * p[0] + 0.587f * p[1] + 0.114f * p[2]) * (1.0f / 255.0f);
    });
    return gray;
}

GrayImage half_size(const GrayImage& image)
{
    GrayImage half(image.width / 2, image.height / 2);
    for (int y = 0; y < half.height; ++y) {
        const float* a = image.row(2 * y);
        const float* b = image.row(2 * y + 1);
        for (int x = 0; x < half.width; ++x)
            half.at(x, y) = 0.25f * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
    }
    return half;
}

ColorImage half_size(const ColorImage& image)
{
    ColorImage half(image.width / 2, image.height / 2);
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                half.at(x, y)[c] =
                    static_cast<std::uint8_t>((image.at(2 * x, 2 * y)[c] + image.at(2 * x + 1, 2 * y)[c] +
                                               image.at(2 * x, 2 * y + 1)[c] + image.at(2 * x + 1, 2 * y + 1)[c] + 2) /
                                              4);
    return half;
}

DepthImage half_depth(const DepthImage& depth)
{
    DepthImage half(depth.width / 2, depth.height / 2);
    for (int y = 0; y < half.height; ++y) {
        for (int x = 0; x < half.width; ++x) {
            float nearest = 0.0f;
            for (const float z : {depth.at(2 * x, 2 * y), depth.at(2 * x + 1, 2 * y), depth.at(2 * x, 2 * y + 1),
                                  depth.at(2 * x + 1, 2 * y + 1)})
                if (z > 0.0f && (nearest == 0.0f || z < nearest)) nearest = z;
            half.at(x, y) = nearest;
        }
    }
    return half;
}

GrayImage smooth(const GrayImage& image, double sigma)
{
    const auto kernel = gaussian_kernel(sigma);
    const int radius = static_cast<int>(kernel.size() / 2);
    GrayImage rows(image.width, image.height), result(image.width, image.height);
    std::vector<float> wide(static_cast<std::size_t>(image.width + 2 * radius)); // a row with its borders repeated
    for (int y = 0; y < image.height; ++y) {
        for (int x = -radius; x < image.width + radius; ++x)
            wide[static_cast<std::size_t>(x + radius)] = image.at(std::clamp(x, 0, image.width - 1), y);
        float* out = rows.row(y);
        for (int k = 0; k <= 2 * radius; ++k) {
            const float* in = wide.data() + k;
            const float weight = kernel[static_cast<std::size_t>(k)];
            for (int x = 0; x < image.width; ++x)
                out[x] += weight * in[x];
        }
    }
    for (int y = 0; y < image.height; ++y) {
        float* out = result.row(y);
        for (int k = -radius; k <= radius; ++k) {
            const float* in = rows.row(std::clamp(y + k, 0, image.height - 1));
            const float weight = kernel[static_cast<std::size_t>(k + radius)];
            for (int x = 0; x < image.width; ++x)
                out[x] += weight * in[x];
        }
    }
    return result;
}

Eigen::Vector3f sample_color_cubic(const ColorImage& image, double x, double y)
{
    const int left = static_cast<int>(std::floor(x)) - 1, top = static_cast<int>(std::floor(y)) - 1;
    const auto across = cubic_weights(static_cast<float>(x - left - 1)),
               down = cubic_weights(static_cast<float>(y - top - 1));
    const bool within = left >= 0 && left + 3 < image.width;
    std::array<float, 12> columns{}; // three channels of four columns
    for (int j = 0; j < 4; ++j) {
        const Rgb8* row = image.row(std::clamp(top + j, 0, image.height - 1));
        std::array<Rgb8, 4> pixels;
        for (int i = 0; i < 4; ++i)
            pixels[static_cast<std::size_t>(i)] = row[within ? left + i : std::clamp(left + i, 0, image.width - 1)];
        std::array<std::uint8_t, 12> channels;
        std::memcpy(channels.data(), pixels.data(), channels.size());
        for (std::size_t k = 0; k < columns.size(); ++k)
            columns[k] += down[static_cast<std::size_t>(j)] * static_cast<float>(channels[k]);
    }
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < 4; ++i)
        color += across[i] * Eigen::Vector3f(columns[3 * i], columns[3 * i + 1], columns[3 * i + 2]);
    return color;
}

} // namespace quoin
