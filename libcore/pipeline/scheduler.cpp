#include "pipeline/scheduler.h"

#include "base/error.h"
#include "base/timer.h"
#include "pipeline/running_task.h"
#include "pipeline/signal_queue.h"
#include "pipeline/stored_results.h"

#include <algorithm>
#include <csignal>
#include <memory>
#include <poll.h>

namespace quoin {
namespace {

constexpr int kTickMilliseconds = 100;
constexpr double kGraceSeconds = 10.0; // that a stage has for cleaning up after SIGTERM

class Scheduler {
public:
    Scheduler(const std::vector<Task>& tasks, const Budget& budget, RunObserver& observer)
        : tasks_(tasks), budget_(budget), observer_(observer),
          stored_(tasks, budget.store), free_{std::max(1, budget.threads), budget.memory},
          max_running_(static_cast<std::size_t>(std::clamp(budget.jobs, 1, std::max(1, budget.threads)))),
          is_started_(tasks.size(), false), is_second_try_(tasks.size(), false), is_looked_up_(tasks.size(), false)
    {
        outcome_.results.resize(tasks.size());
    }

    RunOutcome run()
    {
        SignalQueue signals; // before the first child, so that no end of a child is missed
        start_ready_tasks();
        while (!running_.empty()) {
            wait_for_events(signals);
            while (const auto signal = signals.next_ending_signal())
                end_early(*signal);
            if (is_ending() && since_signal_.seconds() > kGraceSeconds) signal_all(SIGKILL);
            for (const auto& running : running_)
                running->read_output(observer_);
            take_ended_tasks();
            start_ready_tasks();
            observer_.tick();
        }
        return std::move(outcome_);
    }

private:
    bool is_ending() const { return ending_signal_ != 0; }
    bool may_start() const { return !is_ending() && (outcome_.exit_code == 0 || budget_.keep_going); }

    bool is_done(std::size_t task) const
    {
        const TaskState state = outcome_.results[task].state;
        return state == TaskState::Computed || state == TaskState::Cached;
    }

    bool is_ready(std::size_t task) const
    {
        return !is_started_[task] &&
               std::ranges::all_of(tasks_[task].after, [&](std::size_t before) { return is_done(before); });
    }

    std::vector<std::size_t> ready_tasks() const
    {
        std::vector<std::size_t> ready;
        for (std::size_t i = 0; i < tasks_.size(); ++i)
            if (is_ready(i)) ready.push_back(i);
        return ready;
    }

    // Takes from the store what it has of the ready tasks. True when there was any: more may be ready then.
    bool take_stored(const std::vector<std::size_t>& ready)
    {
        bool took_any = false;
        for (const std::size_t task : ready) {
            if (is_looked_up_[task] || !may_start()) continue;
            is_looked_up_[task] = true;
            auto result = stored_.take(task);
            if (!result) continue;
            is_started_[task] = took_any = true;
            finish(task, std::move(*result));
        }
        return took_any;
    }

    void start_ready_tasks()
    {
        auto ready = ready_tasks();
        while (take_stored(ready))
            ready = ready_tasks();
        for (std::size_t i = 0; i < ready.size() && running_.size() < max_running_ && may_start(); ++i)
            start(ready[i], fair_share(std::min(ready.size() - i, max_running_ - running_.size())));
    }

    // What is free, divided among the tasks that are about to start.
    Share fair_share(std::size_t starting) const
    {
        return {std::max(1, free_.threads / static_cast<int>(starting)), free_.memory / starting};
    }

    void start(std::size_t task, const Share& share)
    {
        is_started_[task] = true;
        observer_.started(task);
        try {
            running_.push_back(std::make_unique<RunningTask>(task, tasks_[task], share, budget_));
            free_.threads -= share.threads;
            free_.memory -= share.memory;
        } catch (const Error& error) {
            observer_.said(task, error.what());
            TaskResult result;
            result.state = TaskState::Failed;
            result.end.exit_code = static_cast<int>(error.code());
            finish(task, std::move(result));
        }
    }

    void wait_for_events(const SignalQueue& signals) const
    {
        std::vector<pollfd> waited{{signals.descriptor(), POLLIN, 0}};
        for (const auto& running : running_)
            waited.push_back({running->pipe(), POLLIN, 0}); // poll skips -1
        ::poll(waited.data(), waited.size(), kTickMilliseconds);
    }

    void end_early(int signal)
    {
        if (is_ending()) return signal_all(SIGKILL); // asked twice: at once
        ending_signal_ = signal;
        since_signal_ = Timer();
        outcome_.exit_code = static_cast<int>(ExitCode::Signal) + signal;
        signal_all(SIGTERM);
    }

    void signal_all(int signal) const
    {
        for (const auto& running : running_)
            running->signal(signal);
    }

    void take_ended_tasks()
    {
        for (auto& running : running_) {
            auto result = running->poll_end(observer_);
            if (!result) continue;
            free_.threads += running->share().threads;
            free_.memory += running->share().memory;
            if (is_ending() && result->state == TaskState::Failed) result->state = TaskState::Stopped;
            if (result->state != TaskState::Failed || !run_damaged_again(running->index()))
                finish(running->index(), std::move(*result));
            running.reset();
        }
        std::erase(running_, nullptr);
    }

    // A task may have failed because the store's copy of an input was damaged: whoever made it runs again, then the
    // task.
    bool run_damaged_again(std::size_t task)
    {
        if (is_second_try_[task]) return false;
        const auto damaged = stored_.damaged_inputs(task);
        for (const std::size_t maker : damaged) {
            observer_.said(maker, "its result in the store was damaged; computing it again");
            outcome_.results[maker] = {};
            is_started_[maker] = false;
        }
        is_second_try_[task] = true;
        if (!damaged.empty()) is_started_[task] = false;
        return !damaged.empty();
    }

    void finish(std::size_t task, TaskResult result)
    {
        if (result.state == TaskState::Failed && outcome_.exit_code == 0) outcome_.exit_code = result.end.exit_code;
        outcome_.results[task] = std::move(result);
        stored_.add(task, outcome_.results[task]);
        observer_.ended(task, outcome_.results[task]);
    }

    const std::vector<Task>& tasks_;
    const Budget& budget_;
    RunObserver& observer_;
    StoredResults stored_;
    Share free_;
    std::size_t max_running_;
    std::vector<bool> is_started_;
    std::vector<bool> is_second_try_;
    std::vector<bool> is_looked_up_; // in the store, once it was ready
    std::vector<std::unique_ptr<RunningTask>> running_;
    RunOutcome outcome_;
    int ending_signal_ = 0;
    Timer since_signal_;
};

} // namespace

RunOutcome run_tasks(const std::vector<Task>& tasks, const Budget& budget, RunObserver& observer)
{
    return Scheduler(tasks, budget, observer).run();
}

} // namespace quoin
