// The tasks that can run now: those whose predecessors are done. Every step costs what it touches, not the whole run.
#pragma once

#include "pipeline/plan.h"

#include <cstddef>
#include <set>
#include <vector>

namespace quoin {

class ReadyQueue {
public:
    explicit ReadyQueue(const std::vector<Task>& tasks);

    const std::set<std::size_t>& ready() const { return ready_; } // in the order of the plan

    void take(std::size_t task);     // it runs, or its result was found
    void put_back(std::size_t task); // a task that was taken is to run again, as soon as it can
    void done(std::size_t task);     // those that wait for it may be ready now
    void undo(std::size_t task);     // what was done has to be done again; those that wait for it wait again

private:
    void make_ready_if_free(std::size_t task);

    std::vector<std::vector<std::size_t>> followers_;
    std::vector<std::size_t> missing_; // predecessors that are not done
    std::vector<bool> is_taken_;
    std::set<std::size_t> ready_;
};

} // namespace quoin
