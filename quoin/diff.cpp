#include "base/error.h"
#include "pipeline/process.h"
#include "quoin/verb.h"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

namespace quoin {

// Becomes quoin-diff (quoin/diff/), which lies beside the driver.
int diff_verb(const Arguments& arguments)
{
    const std::string program = executable_path().parent_path() / "quoin-diff";
    Arguments words = arguments;
    words.insert(words.begin(), program);
    std::vector<char*> argv;
    for (auto& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);
    ::execv(program.c_str(), argv.data());
    throw UsageError(fmt::format("{}: cannot be run: {}", program, std::strerror(errno)));
}

} // namespace quoin
