// What the emitters share: a pipeline's command lines with names in place of places, one a stage, good for every scan.
#pragma once

#include "pipeline/graph.h"
#include "pipeline/layout.h"
#include "pipeline/plan.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

// A run as `quoin run` would carry it out.
struct Emission {
    Graph graph;
    std::vector<NamedScan> scans;
    Layout layout;
    std::vector<Task> tasks;   // of all scans
    std::filesystem::path bin; // the folder of the stage executables
};

// How the emitted language spells what differs from scan to scan and from place to place.
struct PlaceNames {
    std::string bin;    // "$(BIN)"
    std::string out;    // "$(OUT)"
    std::string scan;   // the scan's name: "$*"
    std::string folder; // the scan's folder: "$(SCAN_$*)"
    std::string dollar; // a dollar sign that the shell is to see: "$$"
};

struct Rule {
    std::string stage;
    std::string program;                // "$(BIN)/fuse"
    std::vector<std::string> code;      // further files that its result depends on, of a foreign program
    std::vector<std::string> arguments; // "--in scan=$(OUT)/$*/import/scan.safetensors", ...; threads, store and record
                                        // are the emitter's business
    std::vector<std::string> outputs;   // paths
    std::string record;                 // path
    bool reads_folder = false;          // the scan folder is one of its inputs
    std::vector<std::size_t> after;     // rules, always smaller than its own index
};

// One rule a stage that has a task, in the order of the graph.
std::vector<Rule> stage_rules(const Emission& emission, const PlaceNames& names);

// The rule's program and code, separated by blanks.
std::string code_text(const Rule& rule);

// The rules that no other one waits for.
std::vector<const Rule*> last_rules(const std::vector<Rule>& rules);

// The rule's program and arguments and `more`, packed into lines of about `width` that `continuation` joins.
std::string command_text(const Rule& rule, const std::string& more, const std::string& continuation);

// `text` as one word of a POSIX shell.
std::string shell_word(const std::string& text);

// Throws UsageError when a name or path of the emission has a character that Makefiles and Ninja files cannot hold.
void require_plain_names(const Emission& emission);

} // namespace quoin
