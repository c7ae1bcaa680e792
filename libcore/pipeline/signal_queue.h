// Signals to the driver as events of its loop: while a SignalQueue lives, SIGINT, SIGTERM, SIGHUP and SIGCHLD wait in
// it.
#pragma once

#include <csignal>
#include <optional>

namespace quoin {

class SignalQueue {
public:
    SignalQueue();
    ~SignalQueue();
    SignalQueue(const SignalQueue&) = delete;
    SignalQueue& operator=(const SignalQueue&) = delete;

    int descriptor() const { return descriptor_; } // readable when a signal waits

    // The next signal that asks the driver to end; the others are only taken out of the queue.
    std::optional<int> next_ending_signal();

private:
    sigset_t before_{};
    int descriptor_ = -1;
};

} // namespace quoin
