// Progress of the running stage. Algorithms say how far they are; the stage runner decides how to show it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

namespace quoin {

struct ProgressUpdate {
    const std::string& part; // "fusing frames"
    std::size_t done = 0;
    std::size_t total = 0;
};

// Receives updates from any thread, one at a time. Without a sink, updates cost an atomic increment.
void set_progress_sink(std::function<void(const ProgressUpdate&)> sink);

// Counts the items of one part of a stage: `Progress progress("fusing frames", n); ... progress.step();`
class Progress {
public:
    Progress(std::string part, std::size_t total);
    void step(std::size_t items = 1); // thread-safe

private:
    std::string part_;
    std::size_t total_;
    std::atomic<std::size_t> done_{0};
};

} // namespace quoin
