// Child processes: each in a process group of its own, told to end when the driver dies, measured when it ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace quoin {

struct ProcessEnd {
    int exit_code = 0;                   // 128+n after signal n
    std::uint64_t peak_memory_bytes = 0; // largest resident set
    double cpu_seconds = 0.0;            // user and system
    std::size_t left_behind = 0;         // processes of its group that still ran; they are killed
};

enum class Streams { Merged, OutputOnly }; // stdout and stderr in one pipe, or stdout alone (stderr is dropped)

// A running program. Destroying a child that has not ended kills its group and waits.
class ChildProcess {
public:
    // Throws UsageError naming the program when it cannot be started.
    ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, Streams streams);
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&&) = delete;
    ~ChildProcess();

    int pipe() const { return pipe_; } // non-blocking read end

    // Appends what the pipe holds now; false at its end.
    bool read_available(std::string& text) const;

    // The end of the process if it has come; the rest of its group is killed then.
    std::optional<ProcessEnd> poll_end();

    void signal_group(int signal) const;

private:
    pid_t pid_ = -1;
    int pipe_ = -1;
};

struct Captured {
    int exit_code = 0;
    std::string output;
    bool timed_out = false;
};

struct Command {
    std::filesystem::path program;
    std::vector<std::string> arguments;
};

// Runs all commands, a few side by side, and returns what each wrote. The timeout is for each of them.
std::vector<Captured> capture_all(const std::vector<Command>& commands, double timeout_seconds,
                                  Streams streams = Streams::OutputOnly);

// The program of that name in $PATH, if there is one.
std::optional<std::filesystem::path> find_program(const std::string& name);

// The path of the running executable.
std::filesystem::path executable_path();

} // namespace quoin
