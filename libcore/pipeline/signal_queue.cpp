#include "pipeline/signal_queue.h"

#include "base/error.h"

#include <cerrno>
#include <cstring>
#include <sys/signalfd.h>
#include <unistd.h>

namespace quoin {

SignalQueue::SignalQueue()
{
    sigset_t queued;
    sigemptyset(&queued);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD})
        sigaddset(&queued, signal);
    ::pthread_sigmask(SIG_BLOCK, &queued, &before_);
    descriptor_ = ::signalfd(-1, &queued, SFD_NONBLOCK | SFD_CLOEXEC);
    if (descriptor_ < 0) throw ResourceError(std::string("cannot wait for signals: ") + std::strerror(errno));
}

SignalQueue::~SignalQueue()
{
    ::close(descriptor_);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::optional<int> SignalQueue::next_ending_signal()
{
    signalfd_siginfo info{};
    while (::read(descriptor_, &info, sizeof(info)) == static_cast<ssize_t>(sizeof(info)))
        if (info.ssi_signo != SIGCHLD) return static_cast<int>(info.ssi_signo);
    return std::nullopt;
}

} // namespace quoin
