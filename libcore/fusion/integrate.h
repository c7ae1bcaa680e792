#pragma once

#include "fusion/depth_view.h"
#include "fusion/voxel_grid.h"

#include <span>

namespace quoin {

// Adds the views, in order, to every block they see: distances in front of the surface count as free space, those
// behind it as inside down to the truncation. Blocks run in parallel, each through all views, so that it
// stays in the cache.
void integrate(VoxelGrid& grid, std::span<const DepthView> views, const Truncation& truncation);

} // namespace quoin
