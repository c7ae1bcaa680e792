// Growth in rounds: all clusters that are each other's best neighbour join at once.
#pragma once

#include "partition/cluster_graph.h"

namespace quoin {

// Joins until at most `stop_count` clusters are left (a round may halve their number) or rounds join few.
void merge_in_rounds(ClusterGraph& graph, std::size_t stop_count);

} // namespace quoin
