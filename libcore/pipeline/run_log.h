// Writes what a run does into the store's run file (store/run_file.h), and passes everything on to who shows it.
#pragma once

#include "pipeline/scheduler.h"
#include "store/run_file.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

class RunLog : public RunObserver {
public:
    // `store` empty = write nothing.
    RunLog(const std::vector<Task>& tasks, const std::filesystem::path& store, const std::string& pipeline,
           RunObserver& next);

    void started(std::size_t task) override { next_.started(task); }
    void progressed(std::size_t task, const TaskProgress& progress) override { next_.progressed(task, progress); }
    void said(std::size_t task, const std::string& line) override;
    void ended(std::size_t task, const TaskResult& result) override;
    void tick() override { next_.tick(); }

    void end(const RunOutcome& outcome, double seconds);

private:
    const std::vector<Task>& tasks_;
    RunObserver& next_;
    std::optional<Store> store_;
    std::optional<RunFile> file_;
    std::map<std::size_t, std::vector<std::string>> words_; // of tasks that run
};

} // namespace quoin
