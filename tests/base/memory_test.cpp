#include "base/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <vector>

namespace quoin {
namespace {

long page_faults()
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_minflt;
}

TEST(Memory, FreedBuffersAreUsedAgainWithoutPageFaults)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizers bring an allocator of their own";
#endif
    keep_freed_memory();
    constexpr std::size_t kBytes = std::size_t{40} << 20;
    constexpr long kPages = static_cast<long>(kBytes >> 12);
    char sum = std::vector<char>(kBytes, 1).back();
    const long before = page_faults();
    for (int i = 0; i < 3; ++i)
        sum = static_cast<char>(sum + std::vector<char>(kBytes, 1).back());
    EXPECT_EQ(sum, 4);
    EXPECT_LT(page_faults() - before, kPages / 10);
}

} // namespace
} // namespace quoin
