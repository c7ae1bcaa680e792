#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <sys/wait.h>

namespace quoin::test {

struct CommandResult {
    int exit_code = -1;
    std::string output; // stdout and stderr together
};

// Runs a shell command line and waits for it.
inline CommandResult run_command(const std::string& command)
{
    CommandResult result;
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr) return result;
    std::array<char, 4096> buffer{};
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
        result.output.append(buffer.data(), n);
    const int status = ::pclose(pipe);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

} // namespace quoin::test
