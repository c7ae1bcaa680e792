#include "foreign/stage_check.h"

#include "base/error.h"
#include "pipeline/catalogue.h"
#include "pipeline/command_file.h"
#include "pipeline/locate.h"
#include "quoin/option_parser.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// How `name` is run: by itself, and as pipelines run it.
StageUnderTest stage_named(const std::string& name)
{
    Catalogue catalogue(stage_folder());
    const fs::path path = catalogue.locate(name, fs::current_path());
    if (!names_a_path(name) && !fs::exists(path))
        throw UsageError(fmt::format("there is no stage '{}'{}", name, hint(name, catalogue.names())));
    const bool is_file = is_command_file(path.string());
    if (!is_file && !fs::exists(path)) throw UsageError(fmt::format("{}: no such program", path.string()));
    const Command by_itself{path, {}};
    if (path.parent_path() == stage_folder()) return {by_itself, by_itself, {}, {}};
    const Command managed{command_runner(), {path.string()}};
    return {is_file ? managed : by_itself, managed, {}, {}};
}

std::map<std::string, fs::path> parse_inputs(const std::vector<std::string>& arguments)
{
    std::map<std::string, fs::path> inputs;
    for (const auto& argument : arguments) {
        const std::size_t equals = argument.find('=');
        if (equals == std::string::npos) throw UsageError(fmt::format("--in {}: expected PORT=FILE", argument));
        inputs[argument.substr(0, equals)] = fs::absolute(argument.substr(equals + 1));
    }
    return inputs;
}

const char* state_text(CheckResult::State state)
{
    constexpr const char* texts[] = {"ok", "FAILED", "skipped"};
    return texts[static_cast<int>(state)];
}

} // namespace

int stage_check_verb(const Arguments& arguments)
{
    OptionParser parser("tests whether a program honours the stage contract", "quoin stage-check");
    std::string name;
    std::vector<std::string> inputs;
    std::string scan_root;
    parser.option("PROGRAM", name, "a program, a described command line (FILE.yaml), or a stage").required();
    parser.repeated("--in", inputs, "PORT=FILE: an input to test with, where there is no sample");
    parser.option("--scan-root", scan_root, "the folder of the images of that scan");
    if (!parser.parse(arguments)) return 0;
    StageUnderTest stage = stage_named(name);
    stage.inputs = parse_inputs(inputs);
    if (!scan_root.empty()) stage.scan_root = fs::absolute(scan_root);
    const auto results = check_stage(stage);
    for (const auto& result : results)
        fmt::print("{:<8} {}{}\n", state_text(result.state), result.name,
                   result.note.empty() ? "" : ": " + result.note);
    const auto failed = std::ranges::count(results, CheckResult::State::Failed, &CheckResult::state);
    fmt::print("{} checks, {} failed\n", results.size(), failed);
    return failed == 0 ? 0 : 1;
}

} // namespace quoin
