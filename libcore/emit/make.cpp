#include "emit/make.h"

#include <fmt/format.h>

namespace quoin {
namespace {

std::string make_header(const Emission& emission)
{
    std::string scans;
    std::string folders;
    for (const auto& scan : emission.scans) {
        scans += " " + scan.name;
        if (!scan.folder.empty()) folders += fmt::format("SCAN_{} = {}\n", scan.name, scan.folder.string());
    }
    return fmt::format(
        R"(# The pipeline '{}' for GNU make, written by `quoin emit make`. It needs the stage executables, not quoin.
#
#     make -f THIS_FILE -j2 [THREADS=2] [OUT=...] [STORE=...] [CACHE=off]
#
# A rule is a stage, % is a scan. Every stage writes a record of its run last, so a record stands for all its results;
# it is made again when something that it comes from is newer, or when a result was removed. What the store has then
# takes a moment. CACHE=off leaves the store alone.

BIN = {}
OUT = {}
STORE = {}
# threads of every stage, 0 = all
THREADS = 0
CACHE = auto

SCANS ={}
{}
OPTIONS = --threads $(THREADS) --cache $(CACHE) --store $(STORE)
THIS := $(lastword $(MAKEFILE_LIST))

.SECONDARY:
.SECONDEXPANSION:
.PHONY: all again
)",
        emission.graph.name, emission.bin.string(), emission.layout.out.string(), emission.layout.store.string(), scans,
        folders);
}

std::string all_target(const std::vector<Rule>& rules)
{
    std::string records;
    for (const Rule* rule : last_rules(rules))
        records += fmt::format(" $(OUT)/$(scan)/{}/record.json", rule->stage);
    return fmt::format("all: $(foreach scan,$(SCANS),{})\nagain:\n\n", records.substr(1));
}

// Functions that rules call.
std::string definitions(bool reads_folders)
{
    std::string text = "# Results that somebody removed are made again.\n"
                       "lost = $(if $(filter-out $(wildcard $(1)),$(1)),again)\n";
    if (!reads_folders) return text + "\n";
    return text +
           R"(
# The files of the scan folder $(1), as what $@ comes from; hidden files do not count.
list = { printf '%s: %s\n' $@ $(1); \
    find -L $(1) -mindepth 1 -name '.*' -prune -o ! -name '* *' -printf '$@: %p\n%p:\n'; } > $(@D)/folder.d

)";
}

std::string rule_text(const Rule& target, const Rule& recipe, const std::vector<Rule>& targets)
{
    std::string sources;
    for (const std::size_t before : target.after)
        sources += targets[before].record + " ";
    std::string results;
    for (const auto& output : recipe.outputs)
        results += (results.empty() ? "" : " ") + output;
    std::string doubled = results; // $* is known at the second expansion only
    for (std::size_t at = doubled.find("$*"); at != std::string::npos; at = doubled.find("$*", at + 3))
        doubled.insert(at, "$");
    std::string text = fmt::format("{}: {}{} $(THIS) $$(call lost,{})\n\t@mkdir -p $(@D)\n", target.record, sources,
                                   code_text(target), doubled);
    if (target.reads_folder) text += "\t@$(call list,$(SCAN_$*))\n";
    return text + "\t" + command_text(recipe, "$(OPTIONS) --record $@", " \\\n\t    ") + "\n\n";
}

std::string includes(const std::vector<Rule>& rules)
{
    std::string files;
    for (const auto& rule : rules)
        if (rule.reads_folder) files += fmt::format(" $(OUT)/$(scan)/{}/folder.d", rule.stage);
    return files.empty() ? "" : fmt::format("-include $(foreach scan,$(SCANS),{})\n", files.substr(1));
}

} // namespace

std::string make_text(const Emission& emission)
{
    require_plain_names(emission);
    const auto targets = stage_rules(emission, {"$(BIN)", "$(OUT)", "%", "$(SCAN_$*)", "$$"});
    const auto recipes = stage_rules(emission, {"$(BIN)", "$(OUT)", "$*", "$(SCAN_$*)", "$$"});
    std::string text = make_header(emission) + all_target(targets) + definitions(!includes(targets).empty());
    for (std::size_t i = 0; i < targets.size(); ++i)
        text += rule_text(targets[i], recipes[i], targets);
    return text + includes(targets);
}

} // namespace quoin
