#include "pipeline/process.h"

#include "base/error.h"
#include "base/timer.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <sstream>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace quoin {
namespace {

constexpr int kNotStarted = 127; // what a shell returns when a program cannot be executed

struct Pipe {
    int read_end = -1;
    int write_end = -1;
};

Pipe open_pipe()
{
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw ResourceError(std::string("cannot open a pipe: ") + std::strerror(errno));
    return {ends[0], ends[1]};
}

// Runs in the child between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(char* const* argv, int output, Streams streams, pid_t parent)
{
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(128 + SIGTERM); // the driver died before the line above
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::signal(SIGPIPE, SIG_DFL);
    const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(streams == Streams::Merged ? output : nothing, STDERR_FILENO);
    ::execv(argv[0], argv);
    ::_exit(kNotStarted);
}

// Other processes of the group, by /proc/PID/stat: "PID (name) state parent group ...".
std::size_t count_others(pid_t group)
{
    std::size_t count = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
        const std::string name = entry.path().filename().string();
        if (name.find_first_not_of("0123456789") != std::string::npos || name == std::to_string(group)) continue;
        std::ifstream file(entry.path() / "stat");
        std::string line;
        std::getline(file, line);
        const std::size_t bracket = line.rfind(')');
        if (bracket == std::string::npos) continue; // gone meanwhile
        std::istringstream fields(line.substr(bracket + 1));
        char state = 0;
        pid_t parent = 0;
        pid_t its_group = 0;
        if (fields >> state >> parent >> its_group && its_group == group && state != 'Z') ++count;
    }
    return count;
}

ProcessEnd describe_end(int status, const rusage& usage)
{
    ProcessEnd end;
    end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    end.peak_memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    end.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    return end;
}

Captured capture(ChildProcess& child, const Timer& timer, double timeout_seconds)
{
    constexpr int kPollMilliseconds = 100;
    Captured captured;
    while (child.read_available(captured.output) && timer.seconds() < timeout_seconds) {
        pollfd ready{child.pipe(), POLLIN, 0};
        ::poll(&ready, 1, kPollMilliseconds);
    }
    std::optional<ProcessEnd> end = child.poll_end();
    while (!end && timer.seconds() < timeout_seconds) {
        ::poll(nullptr, 0, 1); // stdout is closed: the end is a moment away
        end = child.poll_end();
    }
    captured.timed_out = !end;
    if (end) captured.exit_code = end->exit_code;
    return captured;
}

} // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           Streams streams)
{
    if (::access(program.c_str(), X_OK) != 0)
        throw UsageError(program.string() + ": cannot be run: " + std::strerror(errno));
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);

    const Pipe pipe = open_pipe();
    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ == 0) become(argv.data(), pipe.write_end, streams, parent);
    const int error = errno;
    ::close(pipe.write_end);
    pipe_ = pipe.read_end;
    if (pid_ < 0) {
        ::close(pipe_);
        throw ResourceError(program.string() + ": cannot be started: " + std::strerror(error));
    }
    ::setpgid(pid_, pid_); // in parent and child, whichever comes first
    ::fcntl(pipe_, F_SETFL, O_NONBLOCK);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), pipe_(std::exchange(other.pipe_, -1))
{
}

ChildProcess::~ChildProcess()
{
    if (pid_ > 0) {
        signal_group(SIGKILL);
        while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    if (pipe_ >= 0) ::close(pipe_);
}

bool ChildProcess::read_available(std::string& text) const
{
    char buffer[16384];
    while (true) {
        const ssize_t count = ::read(pipe_, buffer, sizeof(buffer));
        if (count > 0)
            text.append(buffer, static_cast<std::size_t>(count));
        else if (count == 0)
            return false;
        else if (errno != EINTR)
            return true; // nothing there now
    }
}

std::optional<ProcessEnd> ChildProcess::poll_end()
{
    siginfo_t info{};
    if (pid_ <= 0 || ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        info.si_pid == 0)
        return std::nullopt;
    const std::size_t left_behind = count_others(pid_);
    signal_group(SIGKILL); // while the process is not reaped its group id cannot belong to anybody else
    int status = 0;
    rusage usage{};
    while (::wait4(pid_, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    ProcessEnd end = describe_end(status, usage);
    end.left_behind = left_behind;
    return end;
}

void ChildProcess::signal_group(int signal) const
{
    if (pid_ > 0 && ::kill(-pid_, signal) != 0) ::kill(pid_, signal);
}

std::vector<Captured> capture_all(const std::vector<Command>& commands, double timeout_seconds, Streams streams)
{
    constexpr std::size_t kSideBySide = 32;
    std::vector<Captured> results(commands.size());
    for (std::size_t begin = 0; begin < commands.size(); begin += kSideBySide) {
        const std::size_t end = std::min(commands.size(), begin + kSideBySide);
        std::vector<ChildProcess> children;
        for (std::size_t i = begin; i < end; ++i)
            children.emplace_back(commands[i].program, commands[i].arguments, streams);
        const Timer timer;
        for (std::size_t i = begin; i < end; ++i)
            results[i] = capture(children[i - begin], timer, timeout_seconds);
    }
    return results;
}

std::optional<std::filesystem::path> find_program(const std::string& name)
{
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (const auto file = std::filesystem::path(folder) / name; ::access(file.c_str(), X_OK) == 0) return file;
    return std::nullopt;
}

std::filesystem::path executable_path() { return std::filesystem::read_symlink("/proc/self/exe"); }

} // namespace quoin
