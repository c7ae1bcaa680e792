#include "pipeline/retry.h"

#include "base/error.h"
#include "pipeline/text_figures.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

constexpr int kTries = 3;

// Only what the stage itself says: SIGKILL may come from the kernel, which is out of memory, but from a person as well.
bool is_out_of_memory(int exit_code) { return exit_code == static_cast<int>(ExitCode::Resources); }

} // namespace

std::optional<Retry> retry_of(const Attempt& attempt, std::uint64_t capacity, double retry_seconds)
{
    if (attempt.number >= kTries || attempt.timed_out) return std::nullopt;
    const std::string count = fmt::format("(try {} of {})", attempt.number + 1, kTries);
    if (attempt.exit_code == static_cast<int>(ExitCode::TryAgain))
        return Retry{attempt.memory, retry_seconds * attempt.number,
                     fmt::format("asks to be tried again (exit code 75); trying again {}", count)};
    const bool can_have_more = attempt.is_limited ? attempt.memory < capacity : !attempt.was_alone;
    if (!is_out_of_memory(attempt.exit_code) || !can_have_more) return std::nullopt;
    const std::uint64_t more = attempt.is_limited ? std::min(capacity, 2 * attempt.memory) : capacity;
    const std::string change = attempt.is_limited
                                   ? fmt::format(" with {} instead of {}", bytes_text(more), bytes_text(attempt.memory))
                                   : std::string(" with nothing beside it");
    return Retry{more, 0.0, fmt::format("ended with exit code 4 (out of memory); trying again{} {}", change, count)};
}

} // namespace quoin
