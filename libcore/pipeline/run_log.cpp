#include "pipeline/run_log.h"

#include <string_view>

namespace quoin {
namespace {

constexpr std::size_t kWords = 200;       // lines kept of a task: the last ones say why it failed
constexpr std::size_t kLineLength = 2000; // [characters]

std::string_view name_of(TaskState state)
{
    constexpr std::string_view names[] = {"not run", "computed", "cached", "failed", "stopped"};
    return names[static_cast<int>(state)];
}

} // namespace

RunLog::RunLog(const std::vector<Task>& tasks, const std::filesystem::path& store, const std::string& pipeline,
               RunObserver& next)
    : tasks_(tasks), next_(next)
{
    if (store.empty()) return;
    store_.emplace(store);
    file_.emplace(*store_, pipeline);
}

void RunLog::said(std::size_t task, const std::string& line)
{
    auto& words = words_[task];
    if (words.size() == kWords) words.erase(words.begin());
    words.push_back(line.substr(0, kLineLength));
    next_.said(task, line);
}

void RunLog::ended(std::size_t task, const TaskResult& result)
{
    if (file_) {
        RunTask line;
        const std::string& scan = tasks_[task].scan;
        const std::size_t slash = scan.rfind('/'); // VARIANT/SCAN when variants are compared
        line.scan = scan.substr(slash == std::string::npos ? 0 : slash + 1);
        if (slash != std::string::npos) line.variant = scan.substr(0, slash);
        line.stage = tasks_[task].stage;
        line.state = name_of(result.state);
        line.seconds = result.seconds;
        line.peak_memory = result.end.peak_memory_bytes;
        line.exit_code = result.end.exit_code;
        if (result.record) {
            line.key = result.record->key;
            line.outputs = result.record->outputs;
        }
        line.words = words_[task];
        file_->add(line);
    }
    words_.erase(task);
    next_.ended(task, result);
}

void RunLog::end(const RunOutcome& outcome, double seconds)
{
    if (file_) file_->end(outcome.exit_code, seconds);
}

} // namespace quoin
