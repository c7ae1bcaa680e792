// Cuts what a stage prints into lines and tells progress (JSON lines) from words.
#pragma once

#include "pipeline/scheduler.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace quoin {

// {"part": ..., "done": ..., "total": ...}; none for any other line.
std::optional<TaskProgress> parse_progress(std::string_view line);

class LineReader {
public:
    std::string pending; // what has been read and not yet taken

    // Calls take(line) for every whole line; of a line drawn over and over with \r only the last state counts.
    void take_lines(const std::function<void(const std::string&)>& take);

    // The same for what is left at the end of the output.
    void take_rest(const std::function<void(const std::string&)>& take);
};

} // namespace quoin
