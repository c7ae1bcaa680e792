#include "bake/fill.h"

#include "base/parallel.h"

#include <algorithm>
#include <optional>

namespace quoin {
namespace {

bool is_face(const TexelChart& texels, int x, int y) { return texels.face.at(x, y) != kNoFace; }

TexelSource source_of_fill(const TexelChart& texels, int x, int y, TexelSource inside)
{
    return is_face(texels, x, y) ? inside : TexelSource::Gutter;
}

// Mean colour of the chart's own texels; nullopt when none has any.
std::optional<Eigen::Vector3f> mean_color(const TexelChart& texels, const ChartColors& colors)
{
    WeightedColor mean;
    for (std::size_t i = 0; i < texels.face.pixels.size(); ++i)
        if (texels.face.pixels[i] != kNoFace && colors.source.pixels[i] != TexelSource::Empty)
            mean.add(colors.color.pixels[i], 1.0f);
    if (mean.weight == 0.0f) return std::nullopt;
    return mean.color();
}

void fill_chart(const TexelChart& texels, ChartColors& colors)
{
    Image<WeightedColor> known(texels.width(), texels.height());
    for (std::size_t i = 0; i < known.pixels.size(); ++i)
        if (colors.source.pixels[i] != TexelSource::Empty) known.pixels[i].add(colors.color.pixels[i], 1.0f);
    const auto filled = push_pull(known);
    for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
            if (colors.source.at(x, y) != TexelSource::Empty) continue;
            colors.color.at(x, y) = filled.at(x, y);
            colors.source.at(x, y) = source_of_fill(texels, x, y, TexelSource::Filled);
        }
}

// Charts that share a vertex.
std::vector<std::vector<std::uint32_t>> touching_charts(const PlaneMesh& planes, const Atlas& atlas)
{
    std::vector<std::vector<std::uint32_t>> of_vertex(planes.mesh.position.size());
    for (FaceId f = 0; f < planes.mesh.face.size(); ++f)
        for (const VertexId v : planes.mesh.face[f])
            of_vertex[v].push_back(atlas.face_chart[f]);
    std::vector<std::vector<std::uint32_t>> touching(atlas.chart.size());
    for (auto& charts : of_vertex) {
        std::ranges::sort(charts);
        charts.erase(std::ranges::unique(charts).begin(), charts.end());
        for (const auto a : charts)
            for (const auto b : charts)
                if (a != b) touching[a].push_back(b);
    }
    return touching;
}

// Colours of the charts that have none, ring by ring from those that have one.
void spread_means(const std::vector<std::vector<std::uint32_t>>& touching,
                  std::vector<std::optional<Eigen::Vector3f>>& mean)
{
    for (bool spread = true; spread;) {
        spread = false;
        auto next = mean;
        for (std::size_t c = 0; c < mean.size(); ++c) {
            if (mean[c]) continue;
            WeightedColor around;
            for (const auto other : touching[c])
                if (mean[other]) around.add(*mean[other], 1.0f);
            if (around.weight == 0.0f) continue;
            next[c] = around.color();
            spread = true;
        }
        mean = std::move(next);
    }
}

} // namespace

bool is_rim_of_seen(const TexelChart& texels, const ChartColors& colors, int x, int y)
{
    for (int ny = std::max(0, y - 1); ny <= std::min(texels.height() - 1, y + 1); ++ny)
        for (int nx = std::max(0, x - 1); nx <= std::min(texels.width() - 1, x + 1); ++nx)
            if (is_face(texels, nx, ny) && colors.source.at(nx, ny) == TexelSource::Empty) return true;
    return false;
}

Image<Eigen::Vector3f> push_pull(const Image<WeightedColor>& known)
{
    Image<Eigen::Vector3f> filled(known.width, known.height, Eigen::Vector3f::Zero());
    const bool complete = std::ranges::all_of(known.pixels, [](const auto& p) { return p.weight > 0.0f; });
    Image<Eigen::Vector3f> coarse;
    if (!complete && std::max(known.width, known.height) > 1) {
        Image<WeightedColor> cells((known.width + 1) / 2, (known.height + 1) / 2);
        for (int y = 0; y < known.height; ++y)
            for (int x = 0; x < known.width; ++x)
                if (const auto& p = known.at(x, y); p.weight > 0.0f) cells.at(x / 2, y / 2).add(p.color(), 1.0f);
        coarse = push_pull(cells);
    }
    // A pixel is 3/4 of its own cell and 1/4 of the next one, along x and along y.
    const auto pulled = [&](int x, int y) -> Eigen::Vector3f {
        const int cx = x / 2, cy = y / 2;
        const int nx = std::clamp(x % 2 ? cx + 1 : cx - 1, 0, coarse.width - 1),
                  ny = std::clamp(y % 2 ? cy + 1 : cy - 1, 0, coarse.height - 1);
        return 0.75f * (0.75f * coarse.at(cx, cy) + 0.25f * coarse.at(nx, cy)) +
               0.25f * (0.75f * coarse.at(cx, ny) + 0.25f * coarse.at(nx, ny));
    };
    for (int y = 0; y < known.height; ++y)
        for (int x = 0; x < known.width; ++x) {
            if (known.at(x, y).weight > 0.0f)
                filled.at(x, y) = known.at(x, y).color();
            else if (!coarse.empty())
                filled.at(x, y) = pulled(x, y);
        }
    return filled;
}

void fill_from_dense(const PlaneMesh& planes, const TexelChart& texels, const DenseColors& dense, ChartColors& colors)
{
    const TexelPositions positions(planes, texels);
    Image<std::uint8_t> lent(texels.width(), texels.height(), 0);
    Image<WeightedColor> shift(texels.width(), texels.height());
    const auto seen = [&](int x, int y) { return colors.source.at(x, y) != TexelSource::Empty; };
    for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
            if (!is_face(texels, x, y) || (seen(x, y) && !is_rim_of_seen(texels, colors, x, y))) continue;
            const auto face = texels.face.at(x, y);
            const auto color = dense.at(positions.world(face, x, y), positions.normal(face));
            if (!color) continue;
            if (seen(x, y)) {
                shift.at(x, y).add(colors.color.at(x, y) - *color, 1.0f);
            } else {
                colors.color.at(x, y) = *color;
                lent.at(x, y) = 1;
            }
        }
    const auto shifts = push_pull(shift);
    for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
            if (!lent.at(x, y)) continue;
            colors.color.at(x, y) += shifts.at(x, y);
            colors.source.at(x, y) = source_of_fill(texels, x, y, TexelSource::DenseMesh);
        }
}

void fill_rest(const PlaneMesh& planes, const Atlas& atlas, std::vector<ChartColors>& colors)
{
    std::vector<std::optional<Eigen::Vector3f>> mean(atlas.chart.size());
    parallel_for(atlas.chart.size(), [&](std::size_t c) { mean[c] = mean_color(atlas.chart[c], colors[c]); });
    WeightedColor overall;
    for (const auto& color : mean)
        if (color) overall.add(*color, 1.0f);
    constexpr float kMidGray = 128.0f; // nothing has colour at all
    const Eigen::Vector3f fallback = overall.weight > 0.0f ? overall.color() : Eigen::Vector3f::Constant(kMidGray);
    std::vector<std::optional<Eigen::Vector3f>> own = mean;
    spread_means(touching_charts(planes, atlas), mean);

    parallel_for(atlas.chart.size(), [&](std::size_t c) {
        const TexelChart& texels = atlas.chart[c];
        if (own[c]) return fill_chart(texels, colors[c]);
        std::ranges::fill(colors[c].color.pixels, mean[c].value_or(fallback));
        for (int y = 0; y < texels.height(); ++y)
            for (int x = 0; x < texels.width(); ++x)
                colors[c].source.at(x, y) = source_of_fill(texels, x, y, TexelSource::Filled);
    });
}

} // namespace quoin
