// Colours for what no view sees by the safe margins: each texel from the one view that sees it best by the least ones.
#pragma once

#include "bake/atlas.h"
#include "bake/texel_colors.h"
#include "bake/tiles.h"

#include <array>
#include <vector>

namespace quoin {

// Of one chart; works on the tiles that have last views only. Both arguments outlive it.
class LastViews {
public:
    LastViews(const TexelChart& texels, const ChartTiles& tiles);
    // Keyframes ascending.
    void add(const TextureView& view, std::uint32_t keyframe, const TexelPositions& positions);
    // Gives empty texels their colour, shifted smoothly so that it meets the photographs' along the border of what was
    // seen by the safe margins. Differences there of more than `step` grey levels do not count: the views show
    // different things.
    void fill_gaps(ChartColors& colors, double step) const;

private:
    using TileColors = std::array<WeightedColor, std::size_t{kTileSize} * kTileSize>; // the weight is the quality
    void add_tile(const TextureView& view, const TexelPositions& positions, std::size_t gap);
    Eigen::Vector2i first_texel(std::size_t gap) const;
    template <class Visit>
    void for_each_texel(std::size_t gap, const Visit& visit) const;

    const TexelChart* texels_;
    const ChartTiles* tiles_;
    std::vector<std::size_t> tile_; // of every gap
    std::vector<TileColors> best_;  // of every gap
};

} // namespace quoin
