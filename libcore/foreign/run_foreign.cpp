#include "foreign/run_foreign.h"

#include "artifact/artifact.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "foreign/check_artifact.h"
#include "foreign/foreign_program.h"
#include "pipeline/description.h"
#include "pipeline/locate.h"
#include "pipeline/placeholders.h"
#include "pipeline/process.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <map>
#include <poll.h>

namespace quoin {

const Artifact& to_artifact(const Artifact& artifact) { return artifact; } // for StageRun::write

namespace {

namespace fs = std::filesystem;
using Places = std::map<std::string, fs::path>; // by port

// The arguments before the stage's own, and those of the stage's that a program of the contract gets too.
struct Arguments {
    std::string use;
    std::vector<fs::path> code;
    std::vector<char*> stage;        // argv of the stage
    std::vector<std::string> passed; // "--progress", "json", ...
};

Arguments split_arguments(int argc, char** argv)
{
    if (argc < 2 || argv[1][0] == '-')
        throw UsageError("usage: run-command PROGRAM|FILE.yaml[#STAGE] [--code FILE]... STAGE-OPTIONS");
    Arguments arguments{argv[1], {}, {argv[0]}, {}};
    for (int i = 2; i < argc; ++i) {
        const std::string flag = argv[i];
        const bool has_value = i + 1 < argc;
        if (flag == "--code" && has_value) {
            arguments.code.emplace_back(argv[++i]);
            continue;
        }
        if (has_value && (flag == "--progress" || flag == "--log-level" || flag == "--memory"))
            arguments.passed.insert(arguments.passed.end(), {flag, argv[i + 1]});
        arguments.stage.push_back(argv[i]);
    }
    return arguments;
}

Places output_places(const Stage& stage, const StageRun& run, const fs::path& folder)
{
    Places places;
    for (const auto& port : stage.outputs)
        if (run.wants(port.name))
            places[port.name] =
                folder / (is_directory_schema(port.schema_name()) ? port.name : port.name + ".safetensors");
    return places;
}

std::optional<std::string> path_text(bool is_there, const fs::path& path)
{
    return is_there ? std::optional(fs::absolute(path).string()) : std::nullopt;
}

std::vector<std::string> described_words(const ForeignProgram& program, const StageRun& run, const ParamValues& params,
                                         const Places& outputs)
{
    const auto value_of = [&](const std::string& name) -> std::optional<std::string> {
        const std::string rest = name.substr(name.find('.') + 1);
        if (name == "threads") return std::to_string(thread_count());
        if (name == "scan_root") return path_text(!run.scan_root().empty(), run.scan_root());
        if (name.starts_with("in.")) return run.has(rest) ? path_text(true, run.in(rest)) : std::nullopt;
        if (name.starts_with("param.")) return format_param(params.at(rest));
        const auto place = outputs.find(rest);
        return place == outputs.end() ? std::nullopt : path_text(true, place->second);
    };
    std::vector<std::string> words;
    for (const auto& word : program.words)
        if (const auto filled = fill_placeholders(word, value_of)) words.push_back(*filled);
    return words;
}

std::vector<std::string> contract_words(const ForeignProgram& program, const StageRun& run, const ParamValues& params,
                                        const Places& outputs)
{
    std::vector<std::string> words = program.words;
    const auto add = [&](const char* flag, const std::string& value) {
        words.emplace_back(flag);
        words.push_back(value);
    };
    for (const auto& port : program.stage.inputs)
        if (run.has(port.name)) add("--in", port.name + "=" + fs::absolute(run.in(port.name)).string());
    for (const auto& [port, place] : outputs)
        add("--out", port + "=" + place.string());
    for (const auto& [name, value] : params)
        add("--set", name + "=" + format_param(value));
    if (!run.scan_root().empty()) add("--scan-root", fs::absolute(run.scan_root()).string());
    add("--threads", std::to_string(thread_count()));
    return words;
}

// The file that a shell would run for this word.
fs::path find_program(const std::string& word)
{
    if (word.find('/') != std::string::npos) return word;
    if (fs::path file = find_in_path(word); !file.empty()) return file;
    throw UsageError(fmt::format("there is no program '{}' in $PATH; install it, or name it by its path", word));
}

// Runs the program; what it prints goes to stderr as it comes.
ProcessEnd run_to_end(const std::vector<std::string>& words)
{
    constexpr int kPollMilliseconds = 50;
    ChildProcess child(find_program(words.front()), {words.begin() + 1, words.end()}, Streams::Merged);
    bool is_open = true;
    while (true) {
        pollfd ready{is_open ? child.pipe() : -1, POLLIN, 0};
        ::poll(&ready, 1, kPollMilliseconds);
        const auto end = child.poll_end(); // before reading: what it wrote is in the pipe by then
        std::string text;
        if (is_open) is_open = child.read_available(text);
        std::fwrite(text.data(), 1, text.size(), stderr);
        if (end) return *end;
    }
}

// Codes of the contract are passed on; any other failure is one of the program.
void require_success(const ProcessEnd& end, const std::string& program)
{
    if (end.exit_code == 0) return;
    const bool is_of_contract = (end.exit_code >= 2 && end.exit_code <= 5) || end.exit_code == 75;
    throw Error(is_of_contract ? static_cast<ExitCode>(end.exit_code) : ExitCode::Impossible,
                fmt::format("'{}' ended with exit code {}; what it said stands above", program, end.exit_code));
}

void publish(const Port& port, const fs::path& place, const StageRun& run)
{
    if (!fs::exists(place))
        throw ImpossibleError(fmt::format("the program ended well but did not write its output '{}'", port.name));
    if (is_directory_schema(port.schema_name())) {
        run.write_folder(port.name, [&](const fs::path& folder) {
            fs::copy(place, folder, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
        });
        return;
    }
    try {
        check_artifact(place, port.schema_name());
    } catch (const InputError& error) {
        throw ImpossibleError(
            fmt::format("output '{}' of the program is not what it promises: {}", port.name, error.what()));
    }
    run.write(port.name, read_artifact(place));
}

void compute(const ForeignProgram& program, const Arguments& arguments, const StageRun& run, const ParamValues& params)
{
    const TemporaryPath folder(fs::temp_directory_path() / ("quoin-" + program.stage.name));
    fs::create_directory(folder.path());
    const Places outputs = output_places(program.stage, run, folder.path());
    auto words = (program.honours_contract ? contract_words : described_words)(program, run, params, outputs);
    if (program.honours_contract) words.insert(words.end(), arguments.passed.begin(), arguments.passed.end());
    require_success(run_to_end(words), fs::path(words.front()).filename().string());
    for (const auto& port : program.stage.outputs)
        if (const auto place = outputs.find(port.name); place != outputs.end()) publish(port, place->second, run);
}

} // namespace

int run_foreign_stage(int argc, char** argv)
{
    try {
        Arguments arguments = split_arguments(argc, argv);
        const ForeignProgram program = load_foreign_program(arguments.use, arguments.code);
        return run_stage(
            program.stage, program.params, static_cast<int>(arguments.stage.size()), arguments.stage.data(),
            [&](const StageRun& run, const ParamValues& params) { compute(program, arguments, run, params); });
    } catch (const Error& error) { // before there is a stage that could report it
        fmt::print(stderr, "run-command: error: {}\n", error.what());
        return static_cast<int>(error.code());
    }
}

} // namespace quoin
