// A pipeline checked against the stages that it uses: every wire joins an output to an input of its schema, every
// parameter has its type, and the stages stand in an order in which they can run.
#pragma once

#include "pipeline/catalogue.h"
#include "pipeline/pipeline.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

struct GraphInput {
    std::string port;
    std::optional<std::size_t> from; // node; none = the scan folder of the run
    std::string from_port;
};

struct GraphParam {
    std::string name;
    ParamValue value;
    Position position;
};

struct GraphNode {
    std::string name;
    Program program;
    std::vector<GraphInput> inputs; // the wired ones, in the order of the stage's description
    std::vector<GraphParam> params; // the ones that the pipeline sets, sorted by name
};

struct Graph {
    std::string name;
    std::vector<GraphNode> nodes; // a node's inputs come from earlier nodes; ties keep the order of the file

    std::optional<std::size_t> find(const std::string& stage) const;
    bool uses_scan() const;

    // The input that brings `node` the folder with the scan's images: the folder behind its `scan` input, or the only
    // folder behind its other inputs.
    const GraphInput* scan_folder(std::size_t node) const;

    // The nodes behind `node` (or before it), itself included, as a flag for each node.
    std::vector<bool> downstream(std::size_t node) const;
    std::vector<bool> upstream(std::size_t node) const;
};

// Throws UsageError with everything that is wrong, `problems` included. Nothing is run but `--describe`.
Graph build_graph(const Pipeline& pipeline, Catalogue& catalogue, Problems problems);

} // namespace quoin
