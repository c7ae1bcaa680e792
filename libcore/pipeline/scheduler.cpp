#include "pipeline/scheduler.h"

#include "base/error.h"
#include "base/timer.h"
#include "pipeline/ready_queue.h"
#include "pipeline/retry.h"
#include "pipeline/running_task.h"
#include "pipeline/signal_queue.h"
#include "pipeline/stored_results.h"

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <poll.h>
#include <unistd.h>

namespace quoin {
namespace {

constexpr int kTickMilliseconds = 100;
constexpr double kGraceSeconds = 10.0; // that a stage has for cleaning up after SIGTERM

std::uint64_t physical_memory() // [bytes]
{
    return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

class Scheduler {
public:
    Scheduler(const std::vector<Task>& tasks, const Budget& budget, RunObserver& observer)
        : tasks_(tasks), budget_(budget), observer_(observer), stored_(tasks, budget.store), queue_(tasks),
          capacity_(budget.memory > 0 ? budget.memory : physical_memory()), free_{std::max(1, budget.threads),
                                                                                  capacity_},
          max_running_(static_cast<std::size_t>(std::clamp(budget.jobs, 1, std::max(1, budget.threads)))),
          is_second_try_(tasks.size(), false), is_looked_up_(tasks.size(), false)
    {
        outcome_.results.resize(tasks.size());
    }

    RunOutcome run()
    {
        SignalQueue signals; // before the first child, so that no end of a child is missed
        start_ready_tasks();
        while (!running_.empty() || (!delayed_.empty() && may_start())) {
            wait_for_events(signals);
            while (const auto signal = signals.next_ending_signal())
                end_early(*signal);
            if (is_ending() && since_signal_.seconds() > kGraceSeconds) signal_all(SIGKILL);
            for (const auto& running : running_) {
                running->read_output(observer_);
                running->end_if_late(budget_.timeout, kGraceSeconds);
            }
            take_ended_tasks();
            put_back_delayed_tasks();
            start_ready_tasks();
            observer_.tick();
        }
        return std::move(outcome_);
    }

private:
    struct Delayed {
        Timer since;
        double seconds = 0.0;
    };

    bool is_ending() const { return ending_signal_ != 0; }
    bool may_start() const { return !is_ending() && (outcome_.exit_code == 0 || budget_.keep_going); }

    // Takes from the store what it has of the ready tasks, and of those that are ready then.
    void take_stored()
    {
        for (auto next = queue_.ready().begin(); next != queue_.ready().end() && may_start();) {
            const std::size_t task = *next;
            if (!is_looked_up_[task]) {
                is_looked_up_[task] = true;
                if (auto result = stored_.take(task)) {
                    queue_.take(task);
                    finish(task, std::move(*result));
                }
            }
            next = queue_.ready().upper_bound(task);
        }
    }

    void start_ready_tasks()
    {
        take_stored();
        while (running_.size() < max_running_ && may_start() && !queue_.ready().empty()) {
            const std::size_t task = *queue_.ready().begin();
            const std::uint64_t need = memory_need(task);
            // Who needs more than is free waits for others to end; nobody overtakes it, or it might wait for ever.
            if (need > free_.memory && !running_.empty()) return;
            start(task, share_for(task, need));
        }
    }

    std::uint64_t memory_need(std::size_t task) const
    {
        if (const auto raised = raised_memory_.find(task); raised != raised_memory_.end()) return raised->second;
        return std::min(capacity_, budget_.memory_need ? budget_.memory_need(tasks_[task]) : 0);
    }

    // What is free, divided among the tasks that are about to start; no less memory than it needs.
    Share share_for(std::size_t task, std::uint64_t need) const
    {
        const std::size_t starting = std::min(queue_.ready().size(), max_running_ - running_.size());
        const int cores = tasks_[task].description ? tasks_[task].description->cores : 0;
        Share share{std::max(1, free_.threads / static_cast<int>(starting)), need, budget_.memory > 0};
        if (cores > 0) share.threads = std::min(share.threads, cores);
        if (share.is_limited) share.memory = std::max(need, free_.memory / starting);
        return share;
    }

    void start(std::size_t task, const Share& share)
    {
        queue_.take(task);
        observer_.started(task);
        try {
            running_.push_back(std::make_unique<RunningTask>(task, tasks_[task], share, budget_));
            free_.threads -= share.threads;
            free_.memory -= std::min(free_.memory, share.memory);
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
        const std::size_t beside = running_.size() - 1;
        for (auto& running : running_) {
            auto result = running->poll_end(observer_);
            if (!result) continue;
            free_.threads += running->share().threads;
            free_.memory = std::min(capacity_, free_.memory + running->share().memory);
            if (is_ending() && result->state == TaskState::Failed) result->state = TaskState::Stopped;
            const bool runs_again = result->state == TaskState::Failed &&
                                    (run_damaged_again(running->index()) || try_again(*running, *result, beside == 0));
            if (!runs_again) finish(running->index(), std::move(*result));
            running.reset();
        }
        std::erase(running_, nullptr);
    }

    // A task may have failed because the store's copy of an input was damaged: whoever made it runs again, then the
    // task.
    bool run_damaged_again(std::size_t task)
    {
        if (is_second_try_[task]) return false;
        is_second_try_[task] = true;
        const auto damaged = stored_.damaged_inputs(task);
        for (const std::size_t maker : damaged) {
            observer_.said(maker, "its result in the store was damaged; computing it again");
            outcome_.results[maker] = {};
            queue_.undo(maker);
        }
        if (!damaged.empty()) queue_.put_back(task);
        return !damaged.empty();
    }

    bool try_again(const RunningTask& running, const TaskResult& result, bool was_alone)
    {
        const std::size_t task = running.index();
        const Attempt attempt{++tries_[task], result.end.exit_code, running.share().memory, running.share().is_limited,
                              was_alone,      running.is_late()};
        const auto retry = retry_of(attempt, capacity_, budget_.retry_seconds);
        if (!retry) return false;
        observer_.said(task, retry->reason);
        raised_memory_[task] = retry->memory;
        delayed_[task] = {Timer(), retry->delay};
        return true;
    }

    void put_back_delayed_tasks()
    {
        std::erase_if(delayed_, [&](const auto& item) {
            const bool is_due = item.second.since.seconds() >= item.second.seconds;
            if (is_due) queue_.put_back(item.first);
            return is_due;
        });
    }

    void finish(std::size_t task, TaskResult result)
    {
        if (result.state == TaskState::Failed && outcome_.exit_code == 0) outcome_.exit_code = result.end.exit_code;
        outcome_.results[task] = std::move(result);
        const TaskResult& finished = outcome_.results[task];
        stored_.add(task, finished);
        if (finished.state == TaskState::Computed || finished.state == TaskState::Cached) queue_.done(task);
        observer_.ended(task, finished);
    }

    const std::vector<Task>& tasks_;
    const Budget& budget_;
    RunObserver& observer_;
    StoredResults stored_;
    ReadyQueue queue_;
    std::uint64_t capacity_; // [bytes]
    Share free_;
    std::size_t max_running_;
    std::vector<bool> is_second_try_; // after a damaged input
    std::vector<bool> is_looked_up_;  // in the store, once it was ready
    std::map<std::size_t, int> tries_;
    std::map<std::size_t, std::uint64_t> raised_memory_; // [bytes] of tasks that ran out of it
    std::map<std::size_t, Delayed> delayed_;             // tasks that are tried again after a while
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
