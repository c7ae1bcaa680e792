#include "pipeline/catalogue.h"

#include "base/error.h"
#include "pipeline/command_file.h"
#include "pipeline/locate.h"
#include "pipeline/process.h"

#include <algorithm>
#include <fmt/format.h>
#include <unistd.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr double kDescribeSeconds = 30.0; // a stage answers in milliseconds; a program that is none may wait for ever

bool is_program(const fs::path& path) { return fs::is_regular_file(path) && ::access(path.c_str(), X_OK) == 0; }

std::string failure(const fs::path& program, const Captured& captured)
{
    if (captured.timed_out)
        return fmt::format("{}: did not answer --describe within {} s", program.string(), kDescribeSeconds);
    return fmt::format("{}: ended with exit code {} on --describe; is it a Quoin stage?", program.string(),
                       captured.exit_code);
}

// The files that a foreign program is made of.
std::vector<fs::path> code_of(const fs::path& program, const StageDescription& description)
{
    std::vector<fs::path> code{program};
    for (const auto& file : description.code)
        code.push_back(program.parent_path() / file);
    return code;
}

} // namespace

bool names_a_path(const std::string& use) { return use.find('/') != std::string::npos || is_command_file(use); }

Catalogue::Catalogue(fs::path folder, const fs::path& cache) : folder_(std::move(folder)), cache_(cache) {}

std::vector<std::string> Catalogue::names()
{
    std::vector<fs::path> programs;
    for (const auto& entry : fs::directory_iterator(folder_)) {
        const std::string name = entry.path().filename().string();
        const bool may_be_stage = entry.path().extension().empty(); // linkers make libraries executable too
        if (may_be_stage && is_program(entry.path()) && !name.starts_with("quoin") && !name.starts_with("test_") &&
            !name.starts_with("bench_"))
            programs.push_back(entry.path());
    }
    prepare(programs);
    std::vector<std::string> names;
    for (const auto& program : programs) {
        const Answer& answer = answers_.at(program);
        if (answer.error.empty() && answer.program.description.name == program.filename())
            names.push_back(program.filename());
    }
    std::ranges::sort(names);
    return names;
}

fs::path Catalogue::locate(const std::string& use, const fs::path& relative_to) const
{
    if (!names_a_path(use)) return folder_ / use;
    return fs::path(use).is_absolute() ? fs::path(use) : fs::absolute(relative_to / use).lexically_normal();
}

void Catalogue::take(const fs::path& program, const std::string& description)
{
    Answer& answer = answers_[program];
    const bool is_foreign = program.parent_path() != folder_;
    answer.program.path = is_foreign ? command_runner() : program;
    if (is_foreign) answer.program.leading = {program.string()};
    answer.program.description = parse_description(description, program.string());
    if (is_foreign) answer.program.code = code_of(program, answer.program.description);
}

bool Catalogue::take_known(const fs::path& program)
{
    const auto known = cache_.find(program);
    if (!known) return false;
    try {
        take(program, *known);
        return true;
    } catch (const UsageError&) { // the cache is damaged: the program itself knows
        answers_.erase(program);
        return false;
    }
}

void Catalogue::prepare(const std::vector<fs::path>& programs)
{
    std::vector<fs::path> asked;
    for (const auto& program : programs) {
        if (!is_program(program) || answers_.contains(program) || std::ranges::find(asked, program) != asked.end())
            continue;
        if (!take_known(program)) asked.push_back(program);
    }
    std::vector<Command> commands;
    for (const auto& program : asked)
        commands.push_back({program, {"--describe"}});
    const auto captured = capture_all(commands, kDescribeSeconds);
    for (std::size_t i = 0; i < asked.size(); ++i) {
        try {
            if (captured[i].timed_out || captured[i].exit_code != 0) throw UsageError(failure(asked[i], captured[i]));
            take(asked[i], captured[i].output);
            cache_.remember(asked[i], captured[i].output);
        } catch (const UsageError& error) {
            answers_[asked[i]].error = error.what();
        }
    }
}

const Program* Catalogue::describe_command(const fs::path& file, Problems& problems)
{
    Problems found;
    const CommandFile command = read_command_file(file.string(), found);
    problems.add_all(found);
    if (found.has_errors()) return nullptr;
    Program& program = answers_[file].program;
    program = {command_runner(), command.description, {file.string()}, command.code};
    program.code.push_back(command_file_path(file.string()));
    return &program;
}

const Program& Catalogue::describe(const fs::path& program)
{
    if (is_command_file(program.string())) {
        Problems problems;
        const Program* described = describe_command(program, problems);
        problems.throw_if_any();
        return *described;
    }
    if (!fs::exists(program)) throw UsageError(fmt::format("{}: no such program", program.string()));
    if (!is_program(program)) throw UsageError(fmt::format("{}: is not an executable file", program.string()));
    prepare({program});
    const Answer& answer = answers_.at(program);
    if (!answer.error.empty()) throw UsageError(answer.error);
    return answer.program;
}

} // namespace quoin
