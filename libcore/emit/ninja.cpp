#include "emit/ninja.h"

#include <fmt/format.h>

namespace quoin {
namespace {

const PlaceNames kNinjaNames{"$bin", "$results", "$scan", "$folder", "$$"};

std::string ninja_header(const Emission& emission)
{
    return fmt::format(
        R"(# The pipeline '{}' for Ninja, written by `quoin emit ninja`. It needs the stage executables, not quoin.
#
#     ninja -f THIS_FILE [-j2]
#
# Every stage writes a record of its run last, so a record stands for all its results. A stage runs again when its
# command line or something that it comes from has changed, or when a result was removed; what the store has then takes
# a moment.

bin = {}
results = {}
store = {}
builddir = $results
# threads of every stage, 0 = all
threads = 0
cache = auto
options = --threads $threads --cache $cache --store $store

)",
        emission.graph.name, emission.bin.string(), emission.layout.out.string(), emission.layout.store.string());
}

// restat: a result from the store is older than what it comes from; Ninja then goes by the time of the run.
std::string rule_text(const Rule& rule)
{
    std::string text = fmt::format("rule {0}\n  description = $scan: {0}\n  restat = 1\n", rule.stage);
    std::string before = fmt::format("mkdir -p $results/$scan/{} && $\n      ", rule.stage);
    if (rule.reads_folder) {
        const std::string list = fmt::format("$results/$scan/{}/folder.d", rule.stage);
        text += fmt::format("  depfile = {}\n", list);
        before += "{ echo $out: $folder; find -L $folder -mindepth 1 -name '.*' -prune -o ! -name '* *' $\n"
                  "          -printf '$out: %p\\n%p:\\n'; } > " +
                  list + " && $\n      ";
    }
    return text +
           fmt::format("  command = {}{}\n\n", before, command_text(rule, "$options --record $out", " $\n          "));
}

std::string build_text(const Rule& rule, const std::vector<Rule>& rules, const NamedScan& scan)
{
    std::string text = "build " + rule.record + " |";
    for (const auto& output : rule.outputs)
        text += " " + output;
    text += ": " + rule.stage;
    for (const std::size_t before : rule.after)
        text += " " + rules[before].record;
    text += " | " + code_text(rule) + "\n";
    // Build statements know nothing of the variables in their own block.
    for (std::size_t at = text.find("$scan"); at != std::string::npos; at = text.find("$scan"))
        text.replace(at, 5, scan.name);
    text += fmt::format("  scan = {}\n", scan.name);
    return scan.folder.empty() ? text : text + fmt::format("  folder = {}\n", scan.folder.string());
}

} // namespace

std::string ninja_text(const Emission& emission)
{
    require_plain_names(emission);
    const auto rules = stage_rules(emission, kNinjaNames);
    std::string text = ninja_header(emission);
    for (const auto& rule : rules)
        text += rule_text(rule);
    for (const auto& scan : emission.scans)
        for (const auto& rule : rules)
            text += build_text(rule, rules, scan);
    return text;
}

} // namespace quoin
