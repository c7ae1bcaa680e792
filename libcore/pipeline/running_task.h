// One task while it runs: its process, what it prints, and how it ends.
#pragma once

#include "base/timer.h"
#include "pipeline/line_reader.h"
#include "pipeline/process.h"
#include "pipeline/scheduler.h"

#include <cstddef>
#include <optional>
#include <string>

namespace quoin {

// What one task may use.
struct Share {
    int threads = 1;
    std::uint64_t memory = 0; // bytes, as far as they are known
    bool is_limited = false;  // the stage is told
};

class RunningTask {
public:
    // Makes the folders of the outputs and starts the program. Throws Error when either is impossible.
    RunningTask(std::size_t index, const Task& task, const Share& share, const Budget& budget);

    std::size_t index() const { return index_; }
    const Share& share() const { return share_; }
    int pipe() const { return is_silent_ ? -1 : child_.pipe(); } // -1 once the output is closed

    // Hands what the stage printed since the last call to the observer.
    void read_output(RunObserver& observer);

    // Asks it to end once it has run for `timeout` seconds (0 = as long as it likes), and ends it `grace` later.
    void end_if_late(double timeout, double grace);
    bool is_late() const { return is_late_; }

    // The result, once the process has ended. A stage that ends with 0 has written every output in its schema; one that
    // has not has failed.
    std::optional<TaskResult> poll_end(RunObserver& observer);

    void signal(int signal) const { child_.signal_group(signal); }

private:
    void take(const std::string& line, RunObserver& observer);

    std::size_t index_;
    const Task& task_;
    Share share_;
    ChildProcess child_;
    Timer timer_;
    LineReader lines_;
    std::size_t said_ = 0; // lines that were no progress
    bool is_silent_ = false;
    bool is_late_ = false;
};

} // namespace quoin
