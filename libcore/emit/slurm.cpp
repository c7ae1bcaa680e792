#include "emit/slurm.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "emit/resolved_pipeline.h"
#include "pipeline/text_figures.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

namespace fs = std::filesystem;

const PlaceNames kShellNames{R"("$bin")", R"("$results")", R"("$scan")", R"("$folder")", "$"};
constexpr const char* kChain = "chain";

std::vector<ArrayStage> stages_of(const Emission& emission, const std::vector<Forecast>& forecasts)
{
    std::vector<ArrayStage> stages;
    for (const auto& rule : stage_rules(emission, kShellNames))
        stages.push_back({rule.stage, rule.after, std::vector<bool>(emission.scans.size(), false)});
    for (std::size_t i = 0; i < emission.tasks.size(); ++i) {
        const Task& task = emission.tasks[i];
        const auto scan = std::ranges::find(emission.scans, task.scan, &NamedScan::name) - emission.scans.begin();
        const auto stage = std::ranges::find(stages, task.stage, &ArrayStage::name);
        stage->is_stale[static_cast<std::size_t>(scan)] = forecasts[i] != Forecast::Cached;
    }
    return stages;
}

// All stages as one, stale where any of them is.
ArrayStage chained(const std::vector<ArrayStage>& stages)
{
    ArrayStage chain{kChain, {}, std::vector<bool>(stages.front().is_stale.size(), false)};
    for (const auto& stage : stages)
        for (std::size_t scan = 0; scan < chain.is_stale.size(); ++scan)
            chain.is_stale[scan] = chain.is_stale[scan] || stage.is_stale[scan];
    return chain;
}

std::string scans_table(const std::vector<NamedScan>& scans)
{
    std::string text;
    for (std::size_t i = 0; i < scans.size(); ++i)
        text += fmt::format("{}\t{}\t{}\n", i, scans[i].name, scans[i].folder.string());
    return text;
}

constexpr const char* kFunctions = R"bash(
# Sets $scan and $folder to those of line $1 of scans.tsv.
choose_scan() {
    IFS=$'\t' read -r _ scan folder < <(awk -F '\t' -v number="$1" '$1 == number' "$here/scans.tsv") || true
    [ -n "${scan:-}" ] || { echo "$here/scans.tsv has no scan $1" >&2; exit 2; }
}

# The command line of a stage, in $words.
command_of() {
    "words_of_$1"
    mkdir -p "$results/$scan/$1"
    words+=(--store "$store" --record "$results/$scan/$1/record.json")
}

# Puts the result of an earlier stage in its place, from the store. Its key is computed anew from what it reads now: the
# scheduler's word that it is done is not enough, as a job that Slurm has forgotten counts as done.
found() {
    command_of "$1"
    "${words[@]}" --cache only --threads 1 --progress none && return
    echo "$scan: the result of '$1', which this stage reads, is not in the store: submit again" >&2
    exit 3
}

# Computes a stage's result, or finds it in the store. A warning from Slurm is passed on: the stage cleans up and exits
# with 75, "try again".
computed() {
    command_of "$1"
    "${words[@]}" --cache auto --threads "${SLURM_CPUS_PER_TASK:-0}" --progress none &
    local stage=$! code=0
    trap 'kill -USR1 $stage' USR1
    trap 'kill -TERM $stage' TERM
    wait "$stage" || code=$?
    while kill -0 "$stage" 2>/dev/null; do code=0; wait "$stage" || code=$?; done
    [ "$code" -ne 0 ] || return 0
    echo "$scan: '$1' ended with exit code $code" >&2
    if [ "$code" -eq 75 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 3 ]; then scontrol requeue "$SLURM_JOB_ID"; fi
    exit "$code"
}
)bash";

std::string stages_file(const Emission& emission, const std::vector<Rule>& rules, const SlurmOptions& options)
{
    std::string text =
        fmt::format("# The pipeline '{}': where things are, and the command line of every stage; read by "
                    "the batch scripts.\nhere={}\nbin={}\nresults={}\nstore={}\n{}\n",
                    emission.graph.name, shell_word(options.folder.string()), shell_word(emission.bin.string()),
                    shell_word(emission.layout.out.string()), shell_word(emission.layout.store.string()), kFunctions);
    for (const auto& rule : rules)
        text += fmt::format("words_of_{}() {{\n    words=({})\n}}\n\n", rule.stage,
                            command_text(rule, "", "\n           "));
    return text;
}

struct Request {
    std::uint64_t megabytes = 0;
    int minutes = 0;
};

// Half as much again as was ever needed, and something for a start on a slow node.
Request request_of(const std::map<std::string, StageCost>& costs, const std::string& name, const SlurmOptions& options)
{
    constexpr double kMargin = 1.5;
    constexpr double kMegabyte = 1 << 20;
    constexpr std::uint64_t kLeastMegabytes = 256;
    constexpr int kLeastMinutes = 10;
    const auto cost = costs.find(name);
    if (cost == costs.end()) return {0, options.minutes};
    const double megabytes = static_cast<double>(cost->second.peak_memory_bytes) / kMegabyte;
    return {kLeastMegabytes + static_cast<std::uint64_t>(std::ceil(kMargin * megabytes)),
            kLeastMinutes + static_cast<int>(std::ceil(kMargin * cost->second.seconds / 60.0))};
}

Request request_of_chain(const Emission& emission, const std::map<std::string, StageCost>& costs,
                         const SlurmOptions& options)
{
    Request sum;
    bool is_known = true;
    for (const auto& node : emission.graph.nodes) {
        const Request one = request_of(costs, node.program.description.name, options);
        is_known = is_known && one.megabytes > 0;
        sum.megabytes = std::max(sum.megabytes, one.megabytes);
        sum.minutes += one.minutes;
    }
    if (!is_known) sum.megabytes = 0;
    return sum;
}

std::string batch_header(const std::string& name, const Request& request, const SlurmOptions& options)
{
    std::string text =
        fmt::format("#!/bin/bash\n#SBATCH --job-name=quoin-{}\n#SBATCH --output=\"{}/logs/%x.%A_%a.log\"\n"
                    "#SBATCH --cpus-per-task={}\n#SBATCH --mem={}\n#SBATCH --time={}:{:02}:00\n"
                    "#SBATCH --requeue\n#SBATCH --signal=B:USR1@60\n",
                    name, options.folder.string(), options.threads,
                    request.megabytes > 0 ? fmt::format("{}M", request.megabytes) : options.memory,
                    request.minutes / 60, request.minutes % 60);
    for (const auto& directive : options.directives)
        text += "#SBATCH " + directive + "\n";
    return text + fmt::format("# The element's number, plus $1, is a line of scans.tsv.\nset -euo pipefail\n. {}\n"
                              "choose_scan $((SLURM_ARRAY_TASK_ID + ${{1:-0}}))\n",
                              shell_word((options.folder / "stages.sh").string()));
}

// The rules behind one, in order.
std::vector<const Rule*> ancestors(const std::vector<Rule>& rules, std::size_t rule)
{
    std::vector<bool> is_behind(rules.size(), false);
    is_behind[rule] = true;
    for (std::size_t i = rule + 1; i-- > 0;)
        if (is_behind[i])
            for (const std::size_t before : rules[i].after)
                is_behind[before] = true;
    std::vector<const Rule*> found;
    for (std::size_t i = 0; i < rule; ++i)
        if (is_behind[i]) found.push_back(&rules[i]);
    return found;
}

std::string script_name(const std::vector<Rule>& rules, std::size_t rule, const SlurmOptions& options)
{
    return options.is_chain ? "chain.sh" : fmt::format("{:02}-{}.sh", rule + 1, rules[rule].stage);
}

std::string description_name(const Emission& emission, const std::string& stage)
{
    return emission.graph.nodes[*emission.graph.find(stage)].program.description.name;
}

std::vector<SlurmScript> batch_scripts(const Emission& emission, const std::vector<Rule>& rules,
                                       const std::map<std::string, StageCost>& costs, const SlurmOptions& options)
{
    std::vector<SlurmScript> scripts;
    if (options.is_chain) {
        std::string text = batch_header(kChain, request_of_chain(emission, costs, options), options);
        for (const auto& rule : rules)
            text += "computed " + rule.stage + "\n";
        return {{script_name(rules, 0, options), text}};
    }
    for (std::size_t i = 0; i < rules.size(); ++i) {
        const Request request = request_of(costs, description_name(emission, rules[i].stage), options);
        std::string text = batch_header(rules[i].stage, request, options);
        for (const Rule* rule : ancestors(rules, i))
            text += "found " + rule->stage + "\n";
        scripts.push_back({script_name(rules, i, options), text + "computed " + rules[i].stage + "\n"});
    }
    return scripts;
}

constexpr const char* kSubmit = R"bash(set -euo pipefail
cd "$(dirname "$0")"
mkdir -p logs
declare -A id=()
die() { echo "submit.sh: $*" >&2; exit 1; }
command -v sbatch >/dev/null || die "there is no sbatch here: take this folder to a machine that has Slurm"

# Jobs of an earlier submission would compute the same things.
if [ -s jobs.tsv ]; then
    waiting=$(squeue -h -o %i -j "$(cut -f 1 jobs.tsv | paste -s -d ,)" 2>/dev/null || true)
    [ -z "$waiting" ] || die "jobs of an earlier submission are still in the queue: wait for them, or scancel" $waiting
fi

# Whether the cluster could ever run it; asked for all scripts before any is submitted.
preflight() {
    local words
    words=$(sbatch --test-only --array="$2" "$1" 0 2>&1) || die "Slurm refuses $1: ${words#*error: }; change its #SBATCH lines"
}

# NAME SCRIPT OFFSET ELEMENTS [ARRAY THAT IT FOLLOWS]...: an element starts when its own elements of those are done, and is
# cancelled when one of them fails.
submit() {
    local name=$1 script=$2 offset=$3 elements=$4 after=() job
    shift 4
    for array in "$@"; do after+=("${id[$array]}"); done
    local options=(--parsable --array="$elements" --comment="quoin $run $name")
    [ $# -eq 0 ] || options+=(--dependency="aftercorr:$(IFS=:; echo "${after[*]}")" --kill-on-invalid-dep=yes)
    if ! job=$(sbatch "${options[@]}" "$script" "$offset"); then
        [ ${#id[@]} -eq 0 ] || scancel "${id[@]}"
        die "Slurm refuses $script; nothing stays submitted"
    fi
    id[$name]=${job%%;*}
    printf '%s\t%s\t%s\t%s\t%s\n' "${id[$name]}" "$name" "$script" "$offset" "$elements" >>jobs.tsv
    echo "$name: job ${id[$name]}, elements $elements${*:+, after $*}"
}

)bash";

std::string submit_script(const Emission& emission, const std::vector<Rule>& rules, const std::vector<JobArray>& arrays,
                          const SlurmOptions& options)
{
    std::string text =
        fmt::format("#!/bin/bash\n# Submits the pipeline '{}' on {} to Slurm, as far as the store lacked "
                    "its results when `quoin emit slurm` wrote this.\n# An element of an array is a line "
                    "of scans.tsv (less the offset). Log out when it is done.\nrun={}\n",
                    emission.graph.name, count_text(emission.scans.size(), "scan"), shell_word(emission.graph.name)) +
        kSubmit;
    if (arrays.empty()) return text + "echo 'nothing to submit: the store has every result'\n";
    const std::string limit = options.max_running > 0 ? fmt::format("%{}", options.max_running) : "";
    std::string submissions;
    for (const auto& array : arrays) {
        const std::string script = script_name(rules, array.stage, options);
        const std::string elements = elements_text(array.elements) + limit;
        text += fmt::format("preflight {} {}\n", script, elements);
        submissions += fmt::format("submit {} {} {} {}", array.name, script, array.offset, elements);
        for (const std::size_t before : array.follows)
            submissions += " " + arrays[before].name;
        submissions += "\n";
    }
    return text + "\n" + submissions;
}

std::string run_file(const Emission& emission)
{
    const nlohmann::ordered_json json = {{"out", emission.layout.out.string()},
                                         {"store", emission.layout.store.string()},
                                         {"stages", nlohmann::json::array()}};
    auto run = json;
    for (const auto& rule : stage_rules(emission, kShellNames))
        run["stages"].push_back(rule.stage);
    return run.dump(2) + "\n";
}

} // namespace

std::vector<JobArray> slurm_arrays(const Emission& emission, const std::vector<Forecast>& forecasts,
                                   const SlurmOptions& options)
{
    const auto stages = stages_of(emission, forecasts);
    return plan_arrays(options.is_chain ? std::vector{chained(stages)} : stages, options.max_array);
}

std::vector<SlurmScript> slurm_scripts(const Emission& emission, const std::vector<JobArray>& arrays,
                                       const std::map<std::string, StageCost>& costs, const SlurmOptions& options)
{
    const auto rules = stage_rules(emission, kShellNames);
    auto scripts = batch_scripts(emission, rules, costs, options);
    scripts.push_back({"scans.tsv", scans_table(emission.scans)});
    scripts.push_back({"stages.sh", stages_file(emission, rules, options)});
    scripts.push_back({"submit.sh", submit_script(emission, rules, arrays, options)});
    scripts.push_back({"pipeline.yaml", resolved_pipeline(emission)});
    scripts.push_back({"run.json", run_file(emission)});
    return scripts;
}

void write_slurm_folder(const std::vector<SlurmScript>& scripts, const SlurmOptions& options)
{
    std::error_code error;
    fs::create_directories(options.folder / "logs", error);
    if (error)
        throw InputError(fmt::format("{}: cannot make the folder: {}", options.folder.string(), error.message()));
    for (const auto& script : scripts) {
        const fs::path path = options.folder / script.name;
        write_atomically(path, script.text);
        if (script.name == "submit.sh") fs::permissions(path, fs::perms(0755));
    }
}

} // namespace quoin
