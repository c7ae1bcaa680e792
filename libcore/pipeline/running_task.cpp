#include "pipeline/running_task.h"

#include "base/error.h"

#include <filesystem>

namespace quoin {
namespace fs = std::filesystem;
namespace {

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
    if (share.memory > 0) add("--memory", std::to_string(share.memory));
    add("--progress", "json");
    add("--log-level", budget.log_level);
    return {task.program, arguments, Streams::Merged};
}

TaskState state_of(int exit_code, const std::optional<RunRecord>& record)
{
    if (exit_code != 0) return TaskState::Failed;
    return record && record->cached ? TaskState::Cached : TaskState::Computed;
}

} // namespace

RunningTask::RunningTask(std::size_t index, const Task& task, const Share& share, const Budget& budget)
    : index_(index), task_(task), share_(share), child_(spawn(task, share, budget))
{
}

void RunningTask::take(const std::string& line, RunObserver& observer) const
{
    if (const auto progress = parse_progress(line))
        observer.progressed(index_, *progress);
    else
        observer.said(index_, line);
}

void RunningTask::read_output(RunObserver& observer)
{
    if (is_silent_) return;
    is_silent_ = !child_.read_available(lines_.pending);
    lines_.take_lines([&](const std::string& line) { take(line, observer); });
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
    result.record = end->exit_code == 0 ? read_run_record(task_.record) : std::nullopt;
    result.state = state_of(end->exit_code, result.record);
    return result;
}

} // namespace quoin
