#include "base/parallel.h"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

namespace quoin {
namespace {

class Threads : public testing::TestWithParam<int> {
protected:
    void SetUp() override { set_thread_count(GetParam()); }
    void TearDown() override { set_thread_count(0); }
};

// A sum of numbers of very different size: any other order of additions gives other bits.
double sum_of_reciprocals()
{
    const auto map = [](std::size_t begin, std::size_t end) {
        double sum = 0.0;
        for (std::size_t i = begin; i < end; ++i)
            sum += (i % 2 ? -1.0 : 1.0) / std::pow(i + 1.0, 1.1);
        return sum;
    };
    return parallel_reduce(100'003, 64, 0.0, map, [](double a, double b) { return a + b; });
}

TEST_P(Threads, ReductionHasTheBitsOfOneThread)
{
    const double many = sum_of_reciprocals();
    set_thread_count(1);
    EXPECT_EQ(sum_of_reciprocals(), many);
}

TEST_P(Threads, SelectsInOrder)
{
    const auto chosen = parallel_select<std::uint32_t>(10'000, 64, [](std::size_t i) { return i % 3 == 1; });
    ASSERT_EQ(chosen.size(), 3333u);
    for (std::uint32_t i = 0; i < chosen.size(); ++i)
        EXPECT_EQ(chosen[i], 3 * i + 1);
}

TEST_P(Threads, AllOfFindsTheOneThatDiffers)
{
    EXPECT_TRUE(parallel_all_of(0, 64, [](std::size_t) { return false; }));
    EXPECT_TRUE(parallel_all_of(10'000, 64, [](std::size_t i) { return i < 10'000; }));
    for (const std::size_t odd : {0, 63, 64, 9'999})
        EXPECT_FALSE(parallel_all_of(10'000, 64, [&](std::size_t i) { return i != odd; }));
}

TEST_P(Threads, TasksAllRun)
{
    int a = 0, b = 0, c = 0;
    parallel_tasks([&] { a = 1; }, [&] { b = 2; }, [&] { c = 3; });
    EXPECT_EQ(a + 10 * b + 100 * c, 321);
}

TEST_P(Threads, ChunksAreCombinedInOrder)
{
    const auto map = [](std::size_t begin, std::size_t) { return std::vector<std::size_t>{begin}; };
    const auto join = [](std::vector<std::size_t> a, std::vector<std::size_t> b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    };
    const auto order = parallel_reduce(1000, 7, std::vector<std::size_t>{}, map, join);
    ASSERT_EQ(order.size(), 143u);
    for (std::size_t i = 0; i < order.size(); ++i)
        EXPECT_EQ(order[i], 7 * i);
}

TEST_P(Threads, EveryItemIsVisitedOnce)
{
    std::vector<int> visits(1001, 0);
    parallel_for(
        visits.size(), [&](std::size_t i) { ++visits[i]; }, 10);
    for (const int count : visits)
        EXPECT_EQ(count, 1);
}

TEST_P(Threads, AnExceptionOfAChunkReachesTheCaller)
{
    const auto fail_at_500 = [](std::size_t i) {
        if (i == 500) throw std::runtime_error("item 500");
    };
    EXPECT_THROW(parallel_for(1000, fail_at_500), std::runtime_error);
}

TEST_P(Threads, NothingToDoCallsNothing)
{
    parallel_for(0, [](std::size_t) { FAIL(); });
    EXPECT_EQ(parallel_reduce(
                  0, 8, 42, [](std::size_t, std::size_t) { return 1; }, std::plus<int>()),
              42);
}

INSTANTIATE_TEST_SUITE_P(Counts, Threads, testing::Values(1, 2, 4));

} // namespace
} // namespace quoin
