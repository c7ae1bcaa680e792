#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "support/expect_error.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

TEST(Progress, CountsStepsOfAllThreads)
{
    std::size_t most = 0, updates = 0;
    set_progress_sink([&](const ProgressUpdate& update) {
        most = std::max(most, update.done);
        ++updates;
        EXPECT_EQ(update.part, "counting");
        EXPECT_EQ(update.total, 100u);
    });
    Progress progress("counting", 100);
    parallel_for(100, [&](std::size_t) { progress.step(); });
    set_progress_sink({});
    EXPECT_EQ(most, 100u);
    EXPECT_EQ(updates, 101u);
}

TEST(LogLevel, IsParsedByNameAndRefusedOtherwise)
{
    EXPECT_EQ(parse_log_level("warning"), LogLevel::Warning);
    EXPECT_THAT(test::error_of([] { parse_log_level("loud"); }, ExitCode::Usage), testing::HasSubstr("loud"));
}

} // namespace
} // namespace quoin
