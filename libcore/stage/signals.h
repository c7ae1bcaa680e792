#pragma once

namespace quoin {

// From here on SIGINT, SIGTERM (exit 128 + n) and SIGUSR1 (exit 75, try again) end the process with no temporary file
// left behind. Call before any thread is made.
void handle_signals();

} // namespace quoin
