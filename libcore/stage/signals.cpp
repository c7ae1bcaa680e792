#include "stage/signals.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <csignal>
#include <thread>
#include <unistd.h>

namespace quoin {

void handle_signals()
{
    sigset_t signals;
    sigemptyset(&signals);
    for (const int number : {SIGINT, SIGTERM, SIGUSR1})
        sigaddset(&signals, number);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN); // write() then says EFBIG, and the message names the file
    std::thread([signals] {
        int number = 0;
        sigwait(&signals, &number);
        remove_unfinished_files();
        _exit(number == SIGUSR1 ? static_cast<int>(ExitCode::TryAgain) : static_cast<int>(ExitCode::Signal) + number);
    }).detach();
}

} // namespace quoin
