// Drawings of a graph as text, coloured by what the store has.
#pragma once

#include "pipeline/graph.h"

#include <cstddef>
#include <string>
#include <vector>

namespace quoin {

// How many tasks of a node, one a scan, are in which state.
struct NodeState {
    std::size_t stored = 0;  // the store has the result
    std::size_t compute = 0; // it has to be computed
    std::size_t follows = 0; // it depends on one that has to be computed
};

// `states` holds one for each node, or nothing.
// One line a stage.
std::string graph_as_text(const Graph& graph, const std::vector<NodeState>& states = {}, bool in_color = false);
// Graphviz.
std::string graph_as_dot(const Graph& graph, const std::vector<NodeState>& states = {});
// A flowchart that Markdown viewers draw.
std::string graph_as_mermaid(const Graph& graph, const std::vector<NodeState>& states = {});

} // namespace quoin
