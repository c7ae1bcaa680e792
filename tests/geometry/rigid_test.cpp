#include "geometry/rigid.h"

#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

namespace quoin {
namespace {

Twist twist(double wx, double wy, double wz, double x, double y, double z)
{
    Twist t;
    t << wx, wy, wz, x, y, z;
    return t;
}

TEST(ExpTwist, OfZeroIsIdentity) { EXPECT_TRUE(exp_twist(Twist::Zero()).matrix().isIdentity(0.0)); }

TEST(ExpTwist, OfAPureTurnIsTheRotation)
{
    const Rigid turn = exp_twist(twist(0, 0, std::numbers::pi / 2, 0, 0, 0));
    EXPECT_LT((turn * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(ExpTwist, OfAScrewMovesAlongAQuarterCircle)
{
    const Rigid screw = exp_twist(twist(0, 0, std::numbers::pi / 2, std::numbers::pi / 2, 0, 0));
    EXPECT_LT((screw.translation() - Eigen::Vector3d(1, 1, 0)).norm(), 1e-15);
}

TEST(LogTwist, InvertsExpForTinyAndLargeAngles)
{
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (const double angle : {1e-9, 1e-7, 9e-6, 1.1e-5, 1e-3, 9.9e-3, 1.1e-2, 0.5, 2.0, 3.1}) {
        const Eigen::Vector3d axis = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
        Twist t;
        for (int k = 0; k < 3; ++k) {
            t[k] = angle * axis[k];
            t[k + 3] = normal(random);
        }
        EXPECT_LT((log_twist(exp_twist(t)) - t).norm(), 1e-9) << angle;
        EXPECT_TRUE(is_rigid(exp_twist(t).matrix(), 1e-12));
    }
}

TEST(ExpTwist, DerivativeAtZeroIsTheTwistItself)
{
    const Eigen::Vector3d p(0.3, -0.7, 2.0);
    const double h = 1e-6;
    for (int k = 0; k < 6; ++k) {
        Twist step = Twist::Zero();
        step[k] = h;
        const Eigen::Vector3d numeric = (exp_twist(step) * p - exp_twist(-step) * p) / (2 * h);
        Twist unit = Twist::Zero();
        unit[k] = 1.0;
        const Eigen::Vector3d omega = unit.head<3>(), v = unit.tail<3>();
        const Eigen::Vector3d analytic = omega.cross(p) + v;
        EXPECT_LT((numeric - analytic).norm(), 1e-9);
    }
}

TEST(IsRigid, RefusesWhatIsNoRigidTransform)
{
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    EXPECT_TRUE(is_rigid(matrix));
    for (const double bad : {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        EXPECT_FALSE(is_rigid(Eigen::Matrix4d::Constant(bad)));
    EXPECT_FALSE(is_rigid(Eigen::Matrix4d::Zero()));
    EXPECT_FALSE(is_rigid(2.0 * matrix)) << "scaled";
    matrix(1, 1) = -1.0;
    EXPECT_FALSE(is_rigid(matrix)) << "a reflection";
}

TEST(Orthonormalized, BringsADriftedRotationBack)
{
    Rigid drifted = exp_twist(twist(0.2, 0.4, -0.1, 1, 2, 3));
    drifted.linear() *= 1.0 + 1e-4;
    EXPECT_TRUE(is_rigid(orthonormalized(drifted).matrix(), 1e-12));
    EXPECT_EQ(orthonormalized(drifted).translation(), drifted.translation());
}

TEST(RotationAngle, IsSmallForSmallTurnsOfAnySign)
{
    EXPECT_NEAR(rotation_angle(exp_twist(twist(-0.005, 0.004, 0.003, 0, 0, 0)).linear()), std::sqrt(50e-6), 1e-12);
    EXPECT_NEAR(rotation_angle(exp_twist(twist(0, 3.0, 0, 0, 0, 0)).linear()), 3.0, 1e-12);
    EXPECT_EQ(rotation_angle(Eigen::Matrix3d::Identity()), 0.0);
}

} // namespace
} // namespace quoin
