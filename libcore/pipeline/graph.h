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

    bool operator==(const GraphInput&) const = default;
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
    std::vector<GraphNode> nodes;        // a node's inputs come from earlier nodes; ties keep the order of the file
    std::vector<std::string> scans = {}; // "NAME=DIR" or "DIR": those that the pipeline itself names

    std::optional<std::size_t> find(const std::string& stage) const;
    bool uses_scan() const;

    // The input that brings `node` the folder with the scan's images: the folder behind its `scan` input, or the only
    // folder behind its other inputs.
    const GraphInput* scan_folder(std::size_t node) const;

    // The nodes behind `node` (or before it), itself included, as a flag for each node.
    std::vector<bool> downstream(std::size_t node) const;
    std::vector<bool> upstream(std::size_t node) const;
};

// The value of every parameter of the node's stage: its default, or what the pipeline sets.
ParamValues values_of(const GraphNode& node);

// True when both run the same programs on the same inputs with the same values of every parameter.
bool does_the_same(const Graph& a, const Graph& b);

// The graph, or none when there are errors, `problems` included; what is wrong is added to them. Nothing is run but
// `--describe`.
std::optional<Graph> check_graph(const Pipeline& pipeline, Catalogue& catalogue, Problems& problems);

// The same; throws UsageError with everything that is wrong.
Graph build_graph(const Pipeline& pipeline, Catalogue& catalogue, Problems problems);

} // namespace quoin
