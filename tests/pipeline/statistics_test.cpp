#include "pipeline/statistics.h"

#include <cmath>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using testing::DoubleNear;

TEST(Statistics, KnowsTheTableOfStudentsDistribution)
{
    // Two-sided 95 % and 99 %, from the tables.
    EXPECT_THAT(student_quantile(0.975, 1), DoubleNear(12.7062047, 1e-6));
    EXPECT_THAT(student_quantile(0.975, 2), DoubleNear(4.3026527, 1e-6));
    EXPECT_THAT(student_quantile(0.975, 9), DoubleNear(2.2621572, 1e-6));
    EXPECT_THAT(student_quantile(0.995, 4), DoubleNear(4.6040949, 1e-6));
    EXPECT_THAT(student_quantile(0.975, 1e7), DoubleNear(1.9599642, 1e-5)); // the normal distribution
}

TEST(Statistics, TakesDifferencesOfPairs)
{
    // Differences 1, 2, 3: mean 2, standard error 1/sqrt(3).
    const PairedDifference difference = paired_difference({10, 200, 3000}, {11, 202, 3003});
    EXPECT_EQ(difference.pairs, 3U);
    EXPECT_DOUBLE_EQ(difference.mean, 2.0);
    EXPECT_NEAR(*difference.half_width, 4.3026527 / std::sqrt(3.0), 1e-6);
}

TEST(Statistics, HasNoIntervalForOnePair)
{
    EXPECT_EQ(paired_difference({1}, {3}).mean, 2.0);
    EXPECT_FALSE(paired_difference({1}, {3}).half_width.has_value());
    EXPECT_EQ(paired_difference({}, {}).pairs, 0U);
}

} // namespace
} // namespace quoin
