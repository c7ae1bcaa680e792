// Options that several verbs share: which pipeline, on which scans, to which place.
#pragma once

#include "pipeline/catalogue.h"
#include "pipeline/graph.h"
#include "pipeline/layout.h"
#include "pipeline/pipeline.h"
#include "pipeline/plan.h"
#include "pipeline/scheduler.h"
#include "quoin/option_parser.h"

#include <string>
#include <vector>

namespace quoin {

struct PipelineOptions {
    std::string pipeline = "indoor";
    std::vector<std::string> configs;
    std::vector<std::string> settings;
    std::vector<std::string> uses;
    std::string variant;

    void add_to(OptionParser& parser);
    void add_variant_to(OptionParser& parser); // for verbs that work on one variant

    // The pipeline with parameter sets and settings laid over it.
    Pipeline read(Problems& problems) const;

    // The checked graph; warnings go to stderr. Throws UsageError with everything that is wrong in the files and
    // arguments.
    Graph load() const;
};

struct PlaceOptions {
    std::vector<std::string> scans;
    std::string out = "out";
    std::string store;

    void add_to(OptionParser& parser);

    Layout layout() const;

    // The scans to work on. A pipeline that makes its own scan has one unnamed scan: itself.
    std::vector<NamedScan> named_scans(const Graph& graph) const;
};

// Selection and place of a run that is planned or carried out.
struct SelectionOptions {
    Selection selection;

    void add_to(OptionParser& parser);
};

// What a run may use of the machine.
struct BudgetOptions {
    Budget budget; // jobs and threads: 0 = left open
    std::string memory;
    std::string timeout;

    void add_to(OptionParser& parser);

    // With what was left open filled in for so many scans.
    Budget complete(std::size_t scans, const Layout& layout) const;
};

} // namespace quoin
