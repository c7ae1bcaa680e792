// How much the voxels at the surface weigh: much where a scan has many frames, little where it has few.
#pragma once

#include "fusion/voxel_grid.h"

namespace quoin {

// Median weight of the voxels that lie within half a voxel of the surface, over every few blocks; 0 if there are none.
// `truncation` is that of the distances [m].
double typical_surface_weight(const VoxelGrid& grid, double truncation);

} // namespace quoin
