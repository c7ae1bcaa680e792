// Tests whether a program honours the stage contract: what it says of itself, what it refuses and how, what it
// computes, and that keys and the store work with it.
#pragma once

#include "foreign/test_bench.h"

#include <string>
#include <vector>

namespace quoin {

struct CheckResult {
    enum class State { Passed, Failed, Skipped };
    std::string name; // "refuses an unknown parameter"
    State state = State::Passed;
    std::string note; // what went wrong, or why it was skipped
};

// In the order in which they were made. Checks that need inputs are skipped when there is no sample of one and the user
// gave none.
std::vector<CheckResult> check_stage(const StageUnderTest& stage);

} // namespace quoin
