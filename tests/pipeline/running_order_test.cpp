#include "pipeline/running_order.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(RunningOrder, PutsEachBehindWhatItWaitsForAndKeepsTheOrderOtherwise)
{
    EXPECT_THAT(running_order({{2}, {}, {}, {0, 1}}), ElementsAre(1, 2, 0, 3));
}

TEST(RunningOrder, LeavesOutCirclesAndWhatIsBehindThem)
{
    const Waits waits{{}, {2}, {1}, {2}, {0}};
    const auto order = running_order(waits);
    EXPECT_THAT(order, ElementsAre(0, 4));
    EXPECT_THAT(find_circles(waits, order), ElementsAre(ElementsAre(1, 2, 1)));
}

TEST(RunningOrder, FindsEveryCircleThatStandsAlone)
{
    const Waits waits{{0}, {2}, {3}, {1}};
    EXPECT_THAT(find_circles(waits, running_order(waits)), ElementsAre(ElementsAre(0, 0), ElementsAre(1, 3, 2, 1)));
    EXPECT_THAT(find_circles({{}, {0}}, {0, 1}), IsEmpty());
}

} // namespace
} // namespace quoin
