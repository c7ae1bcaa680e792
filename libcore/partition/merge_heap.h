// Exact greedy growth: the cheapest pair of neighbouring clusters joins, again and again (Cai et al. 2017).
#pragma once

#include "partition/cluster_graph.h"

namespace quoin {

// Joins until `target` clusters are left or no neighbours may join. Edges of the graph are used up.
void merge_by_heap(ClusterGraph& graph, std::size_t target);

} // namespace quoin
