#pragma once

#include "fusion/voxel_grid.h"
#include "mesh/triangle_mesh.h"

namespace quoin {

// The zero surface of the grid where all eight corners of a cell weigh at least `min_weight`, as a mesh whose edges
// have at most two faces, counter-clockwise seen from the free side. Colours are interpolated; vertices that no
// observation coloured take that of their neighbours; the mesh has no colours if no voxel has one. Vertices of
// neighbouring blocks are shared.
TriangleMesh extract_surface(const VoxelGrid& grid, double min_weight);

} // namespace quoin
