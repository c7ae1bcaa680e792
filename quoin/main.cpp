// The driver: `quoin VERB ...` or `quoin STAGE ...`.
#include "base/error.h"
#include "pipeline/catalogue.h"
#include "pipeline/locate.h"
#include "pipeline/source.h"
#include "quoin/verb.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <unistd.h>

namespace quoin {
namespace {

struct Verb {
    const char* name;
    const char* summary;
    int (*run)(const Arguments& arguments);
};

constexpr std::array kVerbs{
    Verb{"run", "run a pipeline on scans", run_verb},
    Verb{"plan", "show what a run would compute", plan_verb},
    Verb{"why", "say why a stage would run again, or why not", why_verb},
    Verb{"status", "show what a folder of results holds", status_verb},
    Verb{"ablate", "run variants of a pipeline and compare them", ablate_verb},
    Verb{"graph", "draw a pipeline as text, dot or mermaid", graph_verb},
    Verb{"stages", "list the stages", stages_verb},
    Verb{"describe", "show ports and parameters of a stage", describe_verb},
    Verb{"emit", "write a run down for make, ninja or Slurm; completion; reference pages", emit_verb},
    Verb{"submit", "submit a run to Slurm", submit_verb},
    Verb{"stage-check", "test whether a program honours the stage contract", stage_check_verb},
    Verb{"inspect", "show what an artifact holds and where it comes from", inspect_verb},
    Verb{"report", "write a page that shows a model and its figures", report_verb},
    Verb{"diff", "compare two artifacts, or the results of two runs", diff_verb},
    Verb{"log", "show the runs that used the store, and what their stages said", log_verb},
    Verb{"verify", "read every result of the store; --rerun computes them again and compares", verify_verb},
    Verb{"gc", "free space in the store", gc_verb},
    Verb{"pin", "keep results from gc", pin_verb},
    Verb{"du", "show the disk that the store takes, by stage and variant", du_verb},
};

void print_help()
{
    fmt::print("quoin {}: RGB-D scans of rooms into light, textured meshes of planes\n\n", QUOIN_VERSION);
    fmt::print("  quoin run --scan DIR    makes out/<scan>/model/ by the pipeline `indoor`\n\n");
    for (const auto& verb : kVerbs)
        fmt::print("  quoin {:<12} {}\n", verb.name, verb.summary);
    fmt::print("  quoin STAGE        run one stage by its name\n\n`quoin VERB --help` says more.\n");
}

// Becomes the stage; returns only when there is none of that name.
void become_stage(const std::string& name, char** argv)
{
    const std::filesystem::path program = stage_folder() / name;
    if (name.find('/') != std::string::npos || !std::filesystem::is_regular_file(program)) return;
    ::execv(program.c_str(), argv);
}

[[noreturn]] void refuse(const std::string& name)
{
    std::vector<std::string> names;
    for (const auto& verb : kVerbs)
        names.emplace_back(verb.name);
    std::ranges::copy(Catalogue(stage_folder()).names(), std::back_inserter(names));
    throw UsageError(fmt::format("there is no verb or stage '{}'{}", name, hint(name, names)));
}

int dispatch(int argc, char** argv)
{
    const std::string name = argc > 1 ? argv[1] : "--help";
    if (name == "--help" || name == "-h" || name == "help") {
        print_help();
        return argc > 1 ? 0 : static_cast<int>(ExitCode::Usage);
    }
    if (name == "--version") {
        fmt::print("quoin {}\n", QUOIN_VERSION);
        return 0;
    }
    if (name == "--list-verbs") { // for completion and reference pages
        for (const auto& known : kVerbs)
            fmt::print("{}\n", known.name);
        return 0;
    }
    const auto verb = std::ranges::find(kVerbs, name, [](const Verb& v) { return std::string(v.name); });
    if (verb != kVerbs.end()) return verb->run(Arguments(argv + 2, argv + argc));
    become_stage(name, argv + 1);
    refuse(name);
}

} // namespace
} // namespace quoin

int main(int argc, char** argv)
{
    try {
        return quoin::dispatch(argc, argv);
    } catch (const quoin::Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        fmt::print(stderr, "quoin: internal error: {}\n", error.what());
        return static_cast<int>(quoin::ExitCode::Impossible);
    }
}
