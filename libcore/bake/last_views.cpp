#include "bake/last_views.h"

#include "bake/fill.h"

#include <algorithm>
#include <optional>

namespace quoin {

LastViews::LastViews(const TexelChart& texels, const ChartTiles& tiles) : texels_(&texels), tiles_(&tiles)
{
    for (std::size_t tile = 0; tile < tiles.last_view.size(); ++tile)
        if (!tiles.last_view[tile].empty()) tile_.push_back(tile);
    best_.resize(tile_.size());
}

void LastViews::add(const TextureView& view, std::uint32_t keyframe, const TexelPositions& positions)
{
    for (std::size_t gap = 0; gap < tile_.size(); ++gap)
        if (std::ranges::binary_search(tiles_->last_view[tile_[gap]], keyframe)) add_tile(view, positions, gap);
}

Eigen::Vector2i LastViews::first_texel(std::size_t gap) const
{
    const auto columns = static_cast<std::size_t>(tiles_->columns);
    return {static_cast<int>(tile_[gap] % columns) * kTileSize, static_cast<int>(tile_[gap] / columns) * kTileSize};
}

// Calls visit(x, y, i) for the texels of a gap, i being their place in its colours.
template <class Visit>
void LastViews::for_each_texel(std::size_t gap, const Visit& visit) const
{
    const Eigen::Vector2i first = first_texel(gap);
    for (int y = first.y(); y < std::min(first.y() + kTileSize, texels_->height()); ++y)
        for (int x = first.x(); x < std::min(first.x() + kTileSize, texels_->width()); ++x)
            visit(x, y, static_cast<std::size_t>((y - first.y()) * kTileSize + x - first.x()));
}

void LastViews::add_tile(const TextureView& view, const TexelPositions& positions, std::size_t gap)
{
    const double density = texels_->chart.density;
    const Eigen::Vector2i first = first_texel(gap);
    std::optional<RowAims> aims;
    for_each_texel(gap, [&](int x, int y, std::size_t i) {
        if (x == first.x()) aims.emplace(view, *texels_, positions, TexelRow{{x, y}}, Margins::Least);
        const TextureView::Aim& aim = (*aims)[x];
        if (aim.z == 0.0) return;
        const double trusted = aim.facing * std::min(1.0, view.resolution(aim) / density) * view.sharpness();
        if (trusted <= best_[gap][i].weight) return; // whatever the edges say
        const auto sighting = view.see(aim, Margins::Least);
        if (!sighting) return;
        const auto quality = static_cast<float>(sighting->trust * trusted);
        if (quality <= best_[gap][i].weight) return;
        // At full resolution: coarser pixels would mix in what lies beyond an edge.
        best_[gap][i] = {quality * view.color(*sighting, sighting->resolution), quality};
    });
}

void LastViews::fill_gaps(ChartColors& colors, double step) const
{
    if (tile_.empty()) return;
    Image<WeightedColor> shift(texels_->width(), texels_->height());
    const auto seen = [&](int x, int y) { return colors.source.at(x, y) != TexelSource::Empty; };
    for (std::size_t gap = 0; gap < tile_.size(); ++gap)
        for_each_texel(gap, [&](int x, int y, std::size_t i) {
            const WeightedColor& best = best_[gap][i];
            if (best.weight <= 0.0f || !seen(x, y) || !is_rim_of_seen(*texels_, colors, x, y)) return;
            const Eigen::Vector3f difference = colors.color.at(x, y) - best.color();
            if (difference.cwiseAbs().maxCoeff() <= step) shift.at(x, y).add(difference, 1.0f);
        });
    const auto shifts = push_pull(shift);
    for (std::size_t gap = 0; gap < tile_.size(); ++gap)
        for_each_texel(gap, [&](int x, int y, std::size_t i) {
            const WeightedColor& best = best_[gap][i];
            if (best.weight <= 0.0f || seen(x, y)) return;
            colors.color.at(x, y) = best.color() + shifts.at(x, y);
            colors.source.at(x, y) = TexelSource::Photograph;
        });
}

} // namespace quoin
