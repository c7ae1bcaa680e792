// Growth from seeds: the flattest face that is left starts a region, which takes in neighbours while they fit its
// plane.
#pragma once

#include "partition/cluster_graph.h"

namespace quoin {

struct RegionLimits {
    double max_distance = 0.0; // RMS distance of a face to the region's plane [m]
    double min_cosine = 0.0;   // between the normals of a face and of the region
};

// Joins single faces of `graph` to regions. Faces that fit no region stay alone. opposite: opposite_half_edges(mesh).
void grow_regions(ClusterGraph& graph, const std::vector<std::uint32_t>& opposite, const RegionLimits& limits);

} // namespace quoin
