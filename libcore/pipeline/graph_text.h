// Drawings of a graph as text.
#pragma once

#include "pipeline/graph.h"

#include <string>

namespace quoin {

std::string graph_as_text(const Graph& graph);    // one line a stage: what it reads from whom
std::string graph_as_dot(const Graph& graph);     // Graphviz
std::string graph_as_mermaid(const Graph& graph); // a flowchart that Markdown viewers draw

} // namespace quoin
