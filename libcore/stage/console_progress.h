#pragma once

#include "stage/command_line.h"

#include <string>

namespace quoin {

// Shows progress on stderr until it is destroyed: a bar on a terminal, a line every few seconds elsewhere, or JSON
// lines.
class ConsoleProgress {
public:
    ConsoleProgress(ProgressMode mode, std::string stage);
    ~ConsoleProgress();
    ConsoleProgress(const ConsoleProgress&) = delete;
    ConsoleProgress& operator=(const ConsoleProgress&) = delete;

private:
    bool on_terminal_ = false;
};

} // namespace quoin
