// Growth in rounds: clusters that are each other's best neighbour join at once.
#pragma once

#include "partition/cluster_graph.h"

namespace quoin {

// Joins until at most `stop_count` clusters are left (a round may halve their number) or a round joins few.
void merge_in_rounds(ClusterGraph& graph, std::size_t stop_count);

} // namespace quoin
