#include "base/atomic_file.h"
#include "base/error.h"
#include "emit/completion.h"
#include "emit/make.h"
#include "emit/ninja.h"
#include "emit/reference.h"
#include "pipeline/catalogue.h"
#include "pipeline/locate.h"
#include "pipeline/process.h"
#include "quoin/option_parser.h"
#include "quoin/slurm_options.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <sstream>

namespace quoin {
namespace {

// A format that is one text of a pipeline on scans.
int emit_text(const char* name, std::string (*text_of)(const Emission&), const Arguments& arguments)
{
    OptionParser parser(fmt::format("writes a pipeline on scans as a file for {}", name),
                        fmt::format("quoin emit {}", name));
    EmissionOptions options;
    options.add_to(parser);
    std::string file;
    parser.option("--to", file, "write to this file (default: print)");
    if (!parser.parse(arguments)) return 0;
    const std::string text = text_of(options.load());
    if (file.empty())
        fmt::print("{}", text);
    else
        write_atomically(file, text);
    return 0;
}

int emit_make(const Arguments& arguments) { return emit_text("make", make_text, arguments); }
int emit_ninja(const Arguments& arguments) { return emit_text("ninja", ninja_text, arguments); }

int emit_slurm(const Arguments& arguments)
{
    OptionParser parser("writes a run as a folder of Slurm scripts; its submit.sh submits them", "quoin emit slurm");
    SlurmRun run;
    run.add_to(parser);
    if (!parser.parse(arguments)) return 0;
    fmt::print("{}\n", (run.write() / "submit.sh").lexically_proximate(std::filesystem::current_path()).string());
    return 0;
}

// Every verb and stage, as it describes itself.
CommandHelp command_help()
{
    constexpr double kSeconds = 30.0;
    std::istringstream verbs(capture_all({{executable_path(), {"--list-verbs"}}}, kSeconds).front().output);
    std::vector<Command> commands;
    for (std::string verb; std::getline(verbs, verb);)
        commands.push_back({executable_path(), {verb, "--list-options"}});
    const auto answers = capture_all(commands, kSeconds);
    CommandHelp help;
    for (std::size_t i = 0; i < answers.size(); ++i)
        help.verbs.push_back(parse_verb_help(commands[i].arguments.front(), answers[i].output));
    Catalogue catalogue(stage_folder());
    for (const auto& name : catalogue.names())
        help.stages.push_back(catalogue.describe(stage_folder() / name).description);
    return help;
}

int emit_completion(const Arguments& arguments)
{
    OptionParser parser("writes the completion script of a shell", "quoin emit completion");
    std::string shell;
    parser.option("SHELL", shell, "bash or zsh").required().one_of({"bash", "zsh"});
    if (!parser.parse(arguments)) return 0;
    fmt::print("{}", shell == "bash" ? bash_completion(command_help()) : zsh_completion(command_help()));
    return 0;
}

int emit_reference(const Arguments& arguments)
{
    OptionParser parser("writes reference pages of all verbs and stages", "quoin emit reference");
    std::string folder;
    parser.option("FOLDER", folder, "where to write them: docs/reference").required();
    if (!parser.parse(arguments)) return 0;
    std::filesystem::create_directories(folder);
    for (const auto& [name, text] : reference_pages(command_help()))
        write_atomically(std::filesystem::path(folder) / name, text);
    return 0;
}

struct Format {
    const char* name;
    const char* summary;
    int (*emit)(const Arguments& arguments);
};

constexpr std::array kFormats{
    Format{"make", "a Makefile: one rule a stage", emit_make},
    Format{"ninja", "a Ninja file", emit_ninja},
    Format{"slurm", "a folder of Slurm scripts: an array a stage, an element a scan", emit_slurm},
    Format{"completion", "completion for bash or zsh", emit_completion},
    Format{"reference", "reference pages of all verbs and stages", emit_reference},
};

std::string formats_text()
{
    std::string text = "usage: quoin emit FORMAT ...\n\n";
    for (const auto& format : kFormats)
        text += fmt::format("  quoin emit {:<11} {}\n", format.name, format.summary);
    return text;
}

} // namespace

int emit_verb(const Arguments& arguments)
{
    const std::string name = arguments.empty() ? "" : arguments.front();
    if (name == "--help" || name == "-h") {
        fmt::print("{}", formats_text());
        return 0;
    }
    if (name == "--list-options") {
        fmt::print("writes a pipeline or what is known of the programs in another form: quoin emit FORMAT\n");
        for (const auto& known : kFormats)
            fmt::print("{}\t{}\n", known.name, known.summary);
        return 0;
    }
    const auto format = std::ranges::find(kFormats, name, [](const Format& f) { return std::string(f.name); });
    if (format != kFormats.end()) return format->emit(Arguments(arguments.begin() + 1, arguments.end()));
    std::vector<std::string> names;
    for (const auto& known : kFormats)
        names.emplace_back(known.name);
    throw UsageError(fmt::format("quoin emit: there is no format '{}'{}", name, hint(name, names)));
}

} // namespace quoin
