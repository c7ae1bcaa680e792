// The two kinds of failure: an Error the user can act on (its message says what, where, what was expected and what to
// do), and a bug of ours (assert). The stage runner turns an Error into its exit code and one message; nothing else
// catches.
#pragma once

#include <stdexcept>
#include <string>

namespace quoin {

// Exit codes of the stage contract.
enum class ExitCode : int {
    Done = 0,
    Usage = 2,
    Input = 3,
    Resources = 4,
    Impossible = 5,
    TryAgain = 75,
    Signal = 128
};

class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

// The command line, a parameter or a pipeline is wrong.
struct UsageError : Error {
    explicit UsageError(const std::string& message) : Error(ExitCode::Usage, message) {}
};

// The input data is wrong; the message names the file, the item in it and the value.
struct InputError : Error {
    explicit InputError(const std::string& message) : Error(ExitCode::Input, message) {}
};

// Out of memory, disk or time.
struct ResourceError : Error {
    explicit ResourceError(const std::string& message) : Error(ExitCode::Resources, message) {}
};

// The data is well-formed, yet the stage cannot succeed on it (no plane in the mesh, no usable frame).
struct ImpossibleError : Error {
    explicit ImpossibleError(const std::string& message) : Error(ExitCode::Impossible, message) {}
};

} // namespace quoin
