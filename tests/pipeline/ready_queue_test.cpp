#include "pipeline/ready_queue.h"

#include "pipeline/retry.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// 0 -> 1 -> 3, 0 -> 2 -> 3
std::vector<Task> diamond()
{
    std::vector<Task> tasks(4);
    tasks[1].after = tasks[2].after = {0};
    tasks[3].after = {1, 2};
    return tasks;
}

void finish(ReadyQueue& queue, std::size_t task)
{
    queue.take(task);
    queue.done(task);
}

TEST(ReadyQueue, HoldsWhatCanRunInTheOrderOfThePlan)
{
    ReadyQueue queue(diamond());
    EXPECT_THAT(queue.ready(), ElementsAre(0));
    finish(queue, 0);
    EXPECT_THAT(queue.ready(), ElementsAre(1, 2));
    finish(queue, 2);
    EXPECT_THAT(queue.ready(), ElementsAre(1));
    finish(queue, 1);
    EXPECT_THAT(queue.ready(), ElementsAre(3));
}

TEST(ReadyQueue, LetsWhoReadsWaitWhenAResultIsMadeAgain)
{
    ReadyQueue queue(diamond());
    finish(queue, 0);
    finish(queue, 1);
    queue.take(2); // fails on a damaged result of 0
    queue.undo(0);
    queue.put_back(2);
    EXPECT_THAT(queue.ready(), ElementsAre(0));
    finish(queue, 0);
    EXPECT_THAT(queue.ready(), ElementsAre(2)); // 1 is done and stays done
    finish(queue, 2);
    EXPECT_THAT(queue.ready(), ElementsAre(3));
    queue.take(3);
    EXPECT_THAT(queue.ready(), IsEmpty());
}

TEST(Retry, DoublesTheMemoryAsFarAsItGoes)
{
    EXPECT_EQ(retry_of({1, 4, 300, true}, 1000, 1.0)->memory, 600U);
    EXPECT_EQ(retry_of({2, 4, 600, true}, 1000, 1.0)->memory, 1000U);
    EXPECT_FALSE(retry_of({1, 4, 1000, true}, 1000, 1.0).has_value());
    EXPECT_FALSE(retry_of({3, 4, 300, true}, 1000, 1.0).has_value());
    EXPECT_FALSE(retry_of({1, 4, 300, false, true}, 1000, 1.0).has_value()); // nothing would change
    EXPECT_TRUE(retry_of({1, 4, 300, false, false}, 1000, 1.0).has_value());
}

TEST(Retry, WaitsLongerEveryTime)
{
    EXPECT_EQ(retry_of({1, 75}, 1000, 5.0)->delay, 5.0);
    EXPECT_EQ(retry_of({2, 75}, 1000, 5.0)->delay, 10.0);
}

TEST(Retry, LeavesOtherFailuresAlone)
{
    for (const int code : {1, 2, 3, 5, 137, 139})
        EXPECT_FALSE(retry_of({1, code, 300, true}, 1000, 1.0).has_value()) << code;
    EXPECT_FALSE(retry_of({1, 4, 300, true, true, true}, 1000, 1.0).has_value());
}

} // namespace
} // namespace quoin
