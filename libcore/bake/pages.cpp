#include "bake/pages.h"

#include "base/parallel.h"
#include "image/image_io.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace quoin {
namespace {

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f))); }
Rgb8 to_rgb(const Eigen::Vector3f& color) { return {to_byte(color.x()), to_byte(color.y()), to_byte(color.z())}; }

template <class Visit>
void for_each_owned(const TexelChart& texels, const Visit& visit)
{
    const int block = 2 * texels.margin;
    for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x)
            if (texels.owned.test(x / block, y / block)) visit(x, y);
}

Rgb8 mean_color(const Atlas& atlas, const std::vector<ChartColors>& colors, std::uint32_t page)
{
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
    for (std::size_t c = 0; c < colors.size(); ++c) {
        if (atlas.chart[c].page != page) continue;
        for_each_owned(atlas.chart[c], [&](int x, int y) {
            sum += colors[c].color.at(x, y).cast<double>();
            count += 1.0;
        });
    }
    return to_rgb((sum / std::max(count, 1.0)).cast<float>());
}

// Paints the rectangles of the charts, small ones over large ones: where nothing owns a texel, what is near continues.
void paint_surroundings(const Atlas& atlas, const std::vector<ChartColors>& colors, std::uint32_t page,
                        ColorImage& image)
{
    std::vector<std::size_t> order(atlas.chart.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t c) { return atlas.chart[c].face.pixels.size(); });
    for (const auto c : order) {
        const TexelChart& texels = atlas.chart[c];
        if (texels.page != page) continue;
        for (int y = 0; y < texels.height(); ++y)
            for (int x = 0; x < texels.width(); ++x)
                image.at(texels.x + x, texels.y + y) = to_rgb(colors[c].color.at(x, y));
    }
}

AtlasPage encode_page(const Atlas& atlas, const std::vector<ChartColors>& colors, std::uint32_t page,
                      const BakeTextureParams& params)
{
    const auto size = atlas.page[page];
    ColorImage image(size.width, size.height, mean_color(atlas, colors, page));
    paint_surroundings(atlas, colors, page, image);
    Image<std::uint8_t> source(size.width, size.height, static_cast<std::uint8_t>(TexelSource::Empty));
    parallel_for(atlas.chart.size(), [&](std::size_t c) {
        const TexelChart& texels = atlas.chart[c];
        if (texels.page != page) return;
        for_each_owned(texels, [&](int x, int y) {
            image.at(texels.x + x, texels.y + y) = to_rgb(colors[c].color.at(x, y));
            source.at(texels.x + x, texels.y + y) = static_cast<std::uint8_t>(colors[c].source.at(x, y));
        });
    });
    return {size.width, size.height,
            params.format == PageFormat::Jpeg ? encode_jpeg(image, params.jpeg_quality) : encode_png(image),
            encode_png(source)};
}

} // namespace

std::vector<AtlasPage> encode_pages(const Atlas& atlas, const std::vector<ChartColors>& colors,
                                    const BakeTextureParams& params)
{
    std::vector<AtlasPage> pages(atlas.page.size());
    parallel_for(pages.size(),
                 [&](std::size_t p) { pages[p] = encode_page(atlas, colors, static_cast<std::uint32_t>(p), params); });
    return pages;
}

} // namespace quoin
