// How far a view is off on a chart, part by part: what optimised poses and planes leave of misregistration.
#pragma once

#include "bake/tiles.h"
#include "image/image.h"

namespace quoin {

// Luma of a lattice of points of a chart, whole tiles of them but at the chart's end; 0 = unknown.
using LumaLattice = Image<std::uint8_t>;

// To be added to where a view is sampled, so that it agrees with the mean of the views.
class ResidualShifts {
public:
    // No shift anywhere.
    ResidualShifts() = default;
    // Of each tile by Lucas and Kanade (1981), with its neighbours, for a change of brightness and a shift; the less
    // detail there is in a direction, the nearer to 0 along it. Both lattices have every `stride`-th texel. No shift is
    // longer than `limit` [texel].
    ResidualShifts(const LumaLattice& view, const LumaLattice& mean, int stride, double limit);
    // The texels of one row in a tile, counted from the lattice's first: continuous across tiles.
    TexelRow shifted(TexelRow texels, const Eigen::Vector2i& tile) const;

private:
    Eigen::Vector2f at_corner(int column, int row) const; // upper left one of a tile

    Image<Eigen::Vector2f> shift_; // of every tile [texel]; empty: none
};

} // namespace quoin
