#pragma once

#include "base/error.h"

#include <gmock/gmock.h>

namespace quoin::test {

// The message of the Error that `action` throws; a test failure and "" when it throws none.
template <class Action>
std::string error_of(const Action& action, ExitCode code)
{
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no error was thrown";
    return {};
}

} // namespace quoin::test
