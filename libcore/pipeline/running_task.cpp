#include "pipeline/running_task.h"

#include "artifact/artifact.h"
#include "base/error.h"
#include "pipeline/text_figures.h"

#include <csignal>
#include <filesystem>
#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostLines = 500; // of one stage; a person reads no more

void make_folders(const Task& task)
{
    std::vector<fs::path> files{task.record};
    for (const auto& output : task.outputs)
        files.push_back(output.path);
    for (const auto& file : files) {
        std::error_code error;
        fs::create_directories(file.parent_path(), error);
        if (error) throw InputError(file.parent_path().string() + ": cannot make the folder: " + error.message());
    }
}

ChildProcess spawn(const Task& task, const Share& share, const Budget& budget)
{
    make_folders(task);
    std::error_code missing;
    fs::remove(task.record, missing); // a stage that dies must not leave the record of an earlier run
    std::vector<std::string> arguments = arguments_of(task, budget.store);
    const auto add = [&](const char* flag, std::string value) {
        arguments.emplace_back(flag);
        arguments.push_back(std::move(value));
    };
    add("--threads", std::to_string(share.threads));
    if (share.is_limited) add("--memory", std::to_string(share.memory));
    add("--progress", "json");
    add("--log-level", budget.log_level);
    return {task.program, arguments, Streams::Merged};
}

// What is wrong with an output of a stage that says it is done; "" = nothing.
std::string fault_of(const TaskOutput& output)
{
    if (!fs::exists(output.path))
        return fmt::format("ended with exit code 0, but did not write its output '{}' ({})", output.port,
                           output.path.string());
    if (is_directory_schema(output.schema)) {
        if (fs::is_directory(output.path)) return {};
        return fmt::format("wrote a file as its output '{}', which is a folder ({})", output.port,
                           output.path.string());
    }
    try {
        const ArtifactHeader header = read_artifact_header(output.path);
        if (header.schema == output.schema) return {};
        return fmt::format("wrote a '{}' as its output '{}', which is a '{}' ({})", header.schema, output.port,
                           output.schema, output.path.string());
    } catch (const Error& error) {
        return fmt::format("wrote an output '{}' that is no artifact: {}", output.port, error.what());
    }
}

} // namespace

RunningTask::RunningTask(std::size_t index, const Task& task, const Share& share, const Budget& budget)
    : index_(index), task_(task), share_(share), child_(spawn(task, share, budget))
{
}

void RunningTask::take(const std::string& line, RunObserver& observer)
{
    if (const auto progress = parse_progress(line)) return observer.progressed(index_, *progress);
    if (++said_ <= kMostLines) observer.said(index_, line);
    if (said_ == kMostLines) observer.said(index_, fmt::format("has said {} lines; the rest is not shown", said_));
}

void RunningTask::read_output(RunObserver& observer)
{
    if (is_silent_) return;
    is_silent_ = !child_.read_available(lines_.pending);
    lines_.take_lines([&](const std::string& line) { take(line, observer); });
}

void RunningTask::end_if_late(double timeout, double grace)
{
    if (timeout <= 0.0 || timer_.seconds() < timeout) return;
    if (!is_late_) signal(SIGTERM);
    is_late_ = true;
    if (timer_.seconds() > timeout + grace) signal(SIGKILL);
}

std::optional<TaskResult> RunningTask::poll_end(RunObserver& observer)
{
    const auto end = child_.poll_end();
    if (!end) return std::nullopt;
    read_output(observer);
    lines_.take_rest([&](const std::string& line) { take(line, observer); });
    TaskResult result;
    result.seconds = timer_.seconds();
    result.end = *end;
    const auto fail = [&](ExitCode code, const std::string& why) {
        result.end.exit_code = static_cast<int>(code);
        observer.said(index_, why);
    };
    if (is_late_ && end->exit_code != 0)
        fail(ExitCode::Resources, fmt::format("was ended after {}: --timeout", duration_text(result.seconds)));
    for (const auto& output : task_.outputs)
        if (const std::string fault = result.end.exit_code == 0 ? fault_of(output) : ""; !fault.empty())
            fail(ExitCode::Impossible, fault);
    if (end->left_behind > 0)
        observer.said(index_, fmt::format("left {} of its processes running; they were ended", end->left_behind));
    if (result.end.exit_code != 0) {
        result.state = TaskState::Failed;
        return result;
    }
    result.record = read_run_record(task_.record);
    result.state = result.record && result.record->cached ? TaskState::Cached : TaskState::Computed;
    return result;
}

} // namespace quoin
