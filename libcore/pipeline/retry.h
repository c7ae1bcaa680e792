// Whether a task that failed is tried again, by the class of its failure.
#pragma once

#include "pipeline/scheduler.h"

#include <cstdint>
#include <optional>
#include <string>

namespace quoin {

struct Attempt {
    int number = 1; // of tries so far
    int exit_code = 0;
    std::uint64_t memory = 0; // bytes that it had
    bool is_limited = false;  // it was told to keep to it
    bool was_alone = true;    // nothing ran beside it at its end
    bool timed_out = false;
};

struct Retry {
    std::uint64_t memory = 0; // bytes that it is to have
    double delay = 0.0;       // [s] from now
    std::string reason;       // a line for the person
};

// None when it has failed for good. Out of memory: with twice as much, as far as `capacity` goes, or alone. Try again:
// as it was, after a while. What fails alone and without a limit would fail again.
std::optional<Retry> retry_of(const Attempt& attempt, std::uint64_t capacity, double retry_seconds);

} // namespace quoin
