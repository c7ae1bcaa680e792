#include "scan/layout_text.h"

#include "tiny_scan.h"

#include <cmath>
#include <gmock/gmock.h>

namespace quoin {
namespace {

TEST(ParseNumbers, TakesCommasAndTurnsWordsIntoNaN)
{
    const auto numbers = parse_numbers(" 1.5, -2e3\t+4\r\n-inf nan -1.#IND word");
    ASSERT_EQ(numbers.size(), 7u);
    EXPECT_EQ(numbers[0], 1.5);
    EXPECT_EQ(numbers[1], -2000.0);
    EXPECT_EQ(numbers[2], 4.0);
    EXPECT_EQ(numbers[3], -std::numeric_limits<double>::infinity());
    for (std::size_t i = 4; i < 7; ++i)
        EXPECT_TRUE(std::isnan(numbers[i]));
}

TEST(NumberOf, IsTheLastRunOfDigitsBeforeTheEnding)
{
    EXPECT_EQ(number_of("frame-000012.color.jpg"), 12);
    EXPECT_EQ(number_of("a7b.png"), 7);
    EXPECT_FALSE(number_of("color.1.png").has_value());
    EXPECT_EQ(leading_number("depth/0012_raw.png"), 12);
}

TEST(PoseAt, IsBetweenItsNeighboursAndNeverBeyondTheGap)
{
    const auto poses = test::walk(2);
    const std::vector<TimedPose> trajectory{{1.0, poses[0]}, {2.0, poses[1]}};
    const Eigen::Matrix4d middle = pose_at(trajectory, 1.5, 0.6);
    EXPECT_LT((middle.topRightCorner<3, 1>() - 0.5 * (poses[0] + poses[1]).topRightCorner<3, 1>()).norm(), 1e-12);
    EXPECT_TRUE(is_rigid(middle, 1e-9));
    EXPECT_EQ(pose_at(trajectory, 1.9, 0.2), poses[1]);
    EXPECT_EQ(pose_at(trajectory, 2.1, 0.2), poses[1]);
    EXPECT_TRUE(std::isnan(pose_at(trajectory, 1.5, 0.2)(0, 0)));
    EXPECT_TRUE(std::isnan(pose_at(trajectory, 3.0, 0.2)(0, 0)));
}

TEST(Associate, TakesTheClosestPairsFirstAndEachOnce)
{
    const std::vector<TimedFile> color{{1.00, ""}, {1.03, ""}, {5.0, ""}}, depth{{1.02, ""}, {1.05, ""}};
    const auto partner = associate(color, depth, 0.04);
    EXPECT_EQ(partner[0], std::nullopt); // 1.02 is nearer to 1.03
    EXPECT_EQ(partner[1], 0u);
    EXPECT_EQ(partner[2], std::nullopt);
}

TEST(MatrixFromTum, RefusesAQuaternionThatIsNoRotation)
{
    EXPECT_TRUE(matrix_from_tum({1, 2, 3, 0, 0, 0, 1}, 0).topLeftCorner(3, 3).isIdentity());
    EXPECT_TRUE(std::isnan(matrix_from_tum({1, 2, 3, 0, 0, 0, 0}, 0)(0, 0)));
    EXPECT_TRUE(std::isnan(matrix_from_tum({1, 2, 3}, 0)(0, 0)));
}

} // namespace
} // namespace quoin
