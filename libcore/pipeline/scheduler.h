// Runs tasks as soon as those that they wait for are done: independent ones side by side, within one budget of threads
// and memory. What the store has is put in its place without starting the stage. A signal to the driver ends every
// child; nothing half-written stays, as stages publish whole files only.
#pragma once

#include "pipeline/plan.h"
#include "pipeline/process.h"
#include "pipeline/run_record.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

enum class TaskState {
    NotRun, // it waited for one that failed, or the run was ended before
    Computed,
    Cached, // found in the store
    Failed,
    Stopped, // ended by a signal to the driver
};

struct TaskResult {
    TaskState state = TaskState::NotRun;
    double seconds = 0.0; // of this run, waiting for the store included
    ProcessEnd end;
    std::optional<RunRecord> record;
};

// What a run may use, and how it treats failure.
struct Budget {
    int jobs = 1;             // tasks side by side
    int threads = 1;          // shared by the tasks that run
    std::uint64_t memory = 0; // bytes, shared likewise; 0 = not limited
    bool keep_going = false;  // after a failure, go on with what does not depend on it
    std::filesystem::path store;
    std::string log_level = "warning"; // of the stages
    double timeout = 0.0;              // [s] that a stage may take; 0 = as long as it likes
    double retry_seconds = 1.0;        // [s] before a stage that asks for it is tried again
    // [bytes] that a task will need, as far as one knows; 0 = not known. Tasks that do not fit beside each other wait.
    std::function<std::uint64_t(const Task&)> memory_need = {};
};

struct TaskProgress {
    std::string part; // "fusing frames"
    std::size_t done = 0;
    std::size_t total = 0;
};

// Sees the run from the thread that runs it.
class RunObserver {
public:
    virtual ~RunObserver() = default;
    virtual void started(std::size_t task) = 0; // not called for a task whose result the store has
    virtual void progressed(std::size_t task, const TaskProgress& progress) = 0;
    virtual void said(std::size_t task, const std::string& line) = 0; // anything else that the stage printed
    virtual void ended(std::size_t task, const TaskResult& result) = 0;
    virtual void tick() = 0; // a few times a second
};

struct RunOutcome {
    std::vector<TaskResult> results; // one a task
    int exit_code = 0;               // 0, that of the first task that failed, or 128+n after signal n
};

RunOutcome run_tasks(const std::vector<Task>& tasks, const Budget& budget, RunObserver& observer);

} // namespace quoin
