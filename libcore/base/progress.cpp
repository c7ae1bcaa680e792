#include "base/progress.h"

#include <mutex>

namespace quoin {
namespace {

std::mutex sink_mutex;
std::function<void(const ProgressUpdate&)> progress_sink;
std::atomic<bool> has_sink{false};

void show(const ProgressUpdate& update)
{
    const std::lock_guard lock(sink_mutex);
    if (progress_sink) progress_sink(update);
}

} // namespace

void set_progress_sink(std::function<void(const ProgressUpdate&)> sink)
{
    const std::lock_guard lock(sink_mutex);
    has_sink = static_cast<bool>(sink);
    progress_sink = std::move(sink);
}

Progress::Progress(std::string part, std::size_t total) : part_(std::move(part)), total_(total)
{
    if (has_sink) show({part_, 0, total_});
}

void Progress::step(std::size_t items)
{
    const std::size_t done = done_.fetch_add(items) + items;
    if (has_sink) show({part_, done, total_});
}

} // namespace quoin
