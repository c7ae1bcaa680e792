#include "bake/fill.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace quoin {
namespace {

bool is_face(const TexelChart& texels, int x, int y) { return texels.face.at(x, y) != kNoFace; }

template <class ImageOfPixels>
auto& at_texel(ImageOfPixels& image, const Eigen::Vector2d& texel)
{
    return image.at(std::clamp(static_cast<int>(std::lround(texel.x())), 0, image.width - 1),
                    std::clamp(static_cast<int>(std::lround(texel.y())), 0, image.height - 1));
}

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

// Gives all texels without colour the smooth continuation of the known ones.
void fill_around(const Image<WeightedColor>& known, const TexelChart& texels, ChartColors& colors)
{
    if (std::ranges::find(colors.source.pixels, TexelSource::Empty) == colors.source.pixels.end()) return;
    const auto filled = push_pull(known);
    for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
            if (colors.source.at(x, y) != TexelSource::Empty) continue;
            colors.color.at(x, y) = filled.at(x, y);
            colors.source.at(x, y) = source_of_fill(texels, x, y, TexelSource::Filled);
        }
}

void fill_from_within(const TexelChart& texels, ChartColors& colors)
{
    Image<WeightedColor> known(texels.width(), texels.height());
    for (std::size_t i = 0; i < known.pixels.size(); ++i)
        if (colors.source.pixels[i] != TexelSource::Empty) known.pixels[i].add(colors.color.pixels[i], 1.0f);
    fill_around(known, texels, colors);
}

// Colours charts that have none of their own, ring by ring from those that have.
class NeighbourFill {
public:
    NeighbourFill(const PlaneMesh& planes, const Atlas& atlas, std::vector<char> colored)
        : mesh_(planes.mesh), atlas_(atlas), colored_(std::move(colored)), charts_of_vertex_(mesh_.position.size())
    {
        for (FaceId f = 0; f < mesh_.face.size(); ++f)
            for (const VertexId v : mesh_.face[f])
                if (auto& charts = charts_of_vertex_[v]; std::ranges::count(charts, atlas.face_chart[f]) == 0)
                    charts.push_back(atlas.face_chart[f]);
    }

    // False when no chart without colour touches one with colour.
    bool fill_ring(std::vector<ChartColors>& colors)
    {
        std::vector<char> filled(colored_.size(), 0);
        parallel_for(colored_.size(), [&](std::size_t c) {
            if (colored_[c]) return;
            const auto known = colors_at_vertices(c, colors);
            if (std::ranges::none_of(known.pixels, [](const auto& p) { return p.weight > 0.0f; })) return;
            fill_around(known, atlas_.chart[c], colors[c]);
            filled[c] = 1;
        });
        for (std::size_t c = 0; c < filled.size(); ++c)
            colored_[c] |= filled[c];
        return std::ranges::count(filled, 1) > 0;
    }

private:
    // What the coloured charts around show where the chart touches them.
    Image<WeightedColor> colors_at_vertices(std::size_t c, const std::vector<ChartColors>& colors) const
    {
        const TexelChart& texels = atlas_.chart[c];
        Image<WeightedColor> known(texels.width(), texels.height());
        for (const FaceId f : texels.chart.face)
            for (int k = 0; k < 3; ++k) {
                const Eigen::Vector3d p_world = corner(mesh_, f, k);
                for (const auto other : charts_of_vertex_[mesh_.face[f][static_cast<std::size_t>(k)]])
                    if (colored_[other])
                        at_texel(known, texels.texel(p_world))
                            .add(at_texel(colors[other].color, atlas_.chart[other].texel(p_world)), 1.0f);
            }
        return known;
    }

    const TriangleMesh& mesh_;
    const Atlas& atlas_;
    std::vector<char> colored_;
    std::vector<std::vector<std::uint32_t>> charts_of_vertex_;
};

// Unseen texels, and those beside them, where both colours are known.
bool needs_dense(const TexelChart& texels, const ChartColors& colors, int x, int y)
{
    return is_face(texels, x, y) &&
           (colors.source.at(x, y) == TexelSource::Empty || is_rim_of_seen(texels, colors, x, y));
}

// The dense mesh's colours where a chart needs them: looked up at every kDenseStride-th texel, for its vertices are
// farther apart.
class DenseLattice {
public:
    DenseLattice(const PlaneMesh& planes, const TexelChart& texels, const DenseColors& dense, const ChartColors& colors)
        : texels_(texels), positions_(planes, texels), dense_(dense),
          point_((texels.width() + kDenseStride - 1) / kDenseStride,
                 (texels.height() + kDenseStride - 1) / kDenseStride)
    {
        for (int y = 0; y < point_.height; ++y)
            for (int x = 0; x < point_.width; ++x)
                if (is_needed_near(colors, x * kDenseStride, y * kDenseStride))
                    if (const auto color = look_up(x * kDenseStride, y * kDenseStride))
                        point_.at(x, y).add(*color, 1.0f);
    }

    std::optional<Eigen::Vector3f> at(int x, int y) const
    {
        if (const WeightedColor mean = between(point_, kDenseStride, x, y); mean.weight > 0.0f) return mean.color();
        return has_point_near(x, y) ? std::nullopt : look_up(x, y);
    }

private:
    static constexpr int kDenseStride = 2; // [texel]

    bool is_needed_near(const ChartColors& colors, int x, int y) const
    {
        for (int v = std::max(0, y - kDenseStride + 1); v < std::min(texels_.height(), y + kDenseStride); ++v)
            for (int u = std::max(0, x - kDenseStride + 1); u < std::min(texels_.width(), x + kDenseStride); ++u)
                if (needs_dense(texels_, colors, u, v)) return true;
        return false;
    }
    // Narrow charts pass between the points of the lattice.
    bool has_point_near(int x, int y) const
    {
        const int left = x / kDenseStride * kDenseStride, right = std::min(left + kDenseStride, texels_.width() - 1);
        const int top = y / kDenseStride * kDenseStride, bottom = std::min(top + kDenseStride, texels_.height() - 1);
        return is_face(texels_, left, top) || is_face(texels_, right, top) || is_face(texels_, left, bottom) ||
               is_face(texels_, right, bottom);
    }
    std::optional<Eigen::Vector3f> look_up(int x, int y) const
    {
        if (!is_face(texels_, x, y)) return std::nullopt;
        const auto face = texels_.face.at(x, y);
        return dense_.at(positions_.world(face, x, y), positions_.normal(face));
    }

    const TexelChart& texels_;
    TexelPositions positions_;
    const DenseColors& dense_;
    Image<WeightedColor> point_;
};

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
    const DenseLattice lattice(planes, texels, dense, colors);
    Image<std::uint8_t> lent(texels.width(), texels.height(), 0);
    Image<WeightedColor> shift(texels.width(), texels.height());
    for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
            if (!needs_dense(texels, colors, x, y)) continue;
            const auto color = lattice.at(x, y);
            if (!color) continue;
            if (colors.source.at(x, y) != TexelSource::Empty) {
                shift.at(x, y).add(colors.color.at(x, y) - *color, 1.0f);
            } else {
                colors.color.at(x, y) = *color;
                lent.at(x, y) = 1;
            }
        }
    if (std::ranges::find(lent.pixels, 1) == lent.pixels.end()) return;
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
    std::vector<char> colored(atlas.chart.size(), 0);
    std::vector<std::optional<Eigen::Vector3f>> mean(atlas.chart.size());
    parallel_for(atlas.chart.size(), [&](std::size_t c) {
        mean[c] = mean_color(atlas.chart[c], colors[c]);
        colored[c] = mean[c] ? 1 : 0;
        if (mean[c]) fill_from_within(atlas.chart[c], colors[c]);
    });
    NeighbourFill neighbours(planes, atlas, std::move(colored));
    while (neighbours.fill_ring(colors)) {
    }

    constexpr float kMidGray = 128.0f; // nothing has colour at all
    WeightedColor overall;
    for (const auto& color : mean)
        if (color) overall.add(*color, 1.0f);
    const Eigen::Vector3f fallback = overall.weight > 0.0f ? overall.color() : Eigen::Vector3f::Constant(kMidGray);
    parallel_for(atlas.chart.size(), [&](std::size_t c) {
        Image<WeightedColor> known(atlas.chart[c].width(), atlas.chart[c].height());
        known.pixels[0].add(fallback, 1.0f);
        fill_around(known, atlas.chart[c], colors[c]);
    });
}

} // namespace quoin
