#include "pipeline/ready_queue.h"

namespace quoin {

ReadyQueue::ReadyQueue(const std::vector<Task>& tasks)
    : followers_(tasks.size()), missing_(tasks.size()), is_taken_(tasks.size(), false)
{
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        missing_[i] = tasks[i].after.size();
        for (const std::size_t before : tasks[i].after)
            followers_[before].push_back(i);
        make_ready_if_free(i);
    }
}

void ReadyQueue::make_ready_if_free(std::size_t task)
{
    if (missing_[task] == 0 && !is_taken_[task]) ready_.insert(ready_.end(), task);
}

void ReadyQueue::take(std::size_t task)
{
    is_taken_[task] = true;
    ready_.erase(task);
}

void ReadyQueue::put_back(std::size_t task)
{
    is_taken_[task] = false;
    make_ready_if_free(task);
}

void ReadyQueue::done(std::size_t task)
{
    for (const std::size_t follower : followers_[task]) {
        --missing_[follower];
        make_ready_if_free(follower);
    }
}

void ReadyQueue::undo(std::size_t task)
{
    for (const std::size_t follower : followers_[task]) {
        ++missing_[follower];
        ready_.erase(follower);
    }
    put_back(task);
}

} // namespace quoin
