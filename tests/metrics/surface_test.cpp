#include "metrics/surface.h"

#include "base/parallel.h"
#include "metrics/nearest.h"
#include "metrics/trajectory.h"
#include "support/grids.h"

#include <gmock/gmock.h>
#include <random>

namespace quoin {
namespace {

using Eigen::Vector3d;

TriangleMesh unit_square(double z = 0.0) { return test::grid({0, 0, z}, {1, 0, 0}, {0, 1, 0}, 4, 4); }

std::vector<Vector3d> positions(const std::vector<SurfaceSample>& samples)
{
    std::vector<Vector3d> points;
    for (const SurfaceSample& s : samples)
        points.push_back(s.position);
    return points;
}

TEST(NearestOnTriangle, FindsInsideEdgeAndCorner)
{
    const std::array<Vector3d, 3> t{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    EXPECT_TRUE(nearest_on_triangle({0.2, 0.2, 3.0}, t).isApprox(Vector3d(0.2, 0.2, 0)));
    EXPECT_TRUE(nearest_on_triangle({0.5, -1.0, 1.0}, t).isApprox(Vector3d(0.5, 0, 0)));
    EXPECT_TRUE(nearest_on_triangle({2.0, 2.0, 0.0}, t).isApprox(Vector3d(0.5, 0.5, 0)));
    EXPECT_TRUE(nearest_on_triangle({3.0, -1.0, 1.0}, t).isApprox(Vector3d(1, 0, 0)));
}

TEST(NearestItem, AgreesWithTryingEveryTriangle)
{
    const TriangleMesh mesh = test::room_corner(5, 0.05);
    const NearestItem tree(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-0.5, 1.5);
    for (int i = 0; i < 200; ++i) {
        const Vector3d p(place(random), place(random), place(random));
        double best = 1e9;
        for (FaceId f = 0; f < mesh.face.size(); ++f)
            best = std::min(
                best,
                (nearest_on_triangle(p, {corner(mesh, f, 0), corner(mesh, f, 1), corner(mesh, f, 2)}) - p).norm());
        const auto found = tree.find(p, 10.0);
        ASSERT_TRUE(found.has_value());
        EXPECT_NEAR(found->distance, best, 1e-9);
    }
}

TEST(NearestItem, FindsNothingBeyondItsReach)
{
    const NearestItem tree(unit_square());
    EXPECT_FALSE(tree.find({0.5, 0.5, 0.2}, 0.1).has_value());
    EXPECT_TRUE(tree.find({0.5, 0.5, 0.2}, 0.3).has_value());
    EXPECT_FALSE(NearestItem(std::vector<Segment3>{}).find({0, 0, 0}, 1.0).has_value());
}

TEST(NearestItem, TakesTheSmallestOfSegmentsAtTheSameDistance)
{
    const NearestItem tree(
        std::vector<Segment3>{{Vector3d(1, 0, 0), Vector3d(1, 1, 0)}, {Vector3d(-1, 0, 0), Vector3d(-1, 1, 0)}});
    EXPECT_EQ(tree.find({0, 0.5, 0}, 2.0)->item, 0u);
}

TEST(SampleSurface, SpreadsPointsByArea)
{
    TriangleMesh mesh = unit_square();
    test::append(mesh, test::grid({5, 0, 0}, {3, 0, 0}, {0, 1, 0}, 1, 1)); // three times the area in 2 of 34 faces
    const auto samples = sample_surface(mesh, 4000);
    const auto far =
        std::count_if(samples.begin(), samples.end(), [](const SurfaceSample& s) { return s.position.x() > 4.0; });
    EXPECT_NEAR(static_cast<double>(far), 3000.0, 2.0);
    Vector3d mean = Vector3d::Zero();
    for (const SurfaceSample& s : samples)
        if (s.position.x() < 4.0) mean += s.position / 1000.0;
    EXPECT_NEAR((mean - Vector3d(0.5, 0.5, 0)).norm(), 0.0, 0.01);
}

TEST(Distances, OfTwoParallelSquaresAreTheirGap)
{
    const auto found = distances(positions(sample_surface(unit_square(0.007), 500)), NearestItem(unit_square()), 0.5);
    const DistanceStatistics s = statistics(found);
    EXPECT_NEAR(s.mean, 0.007, 1e-6);
    EXPECT_NEAR(s.rms, 0.007, 1e-6);
    EXPECT_NEAR(s.p95, 0.007, 1e-6);
    EXPECT_EQ(share_within(found, 0.005), 0.0);
    EXPECT_EQ(share_within(found, 0.010), 1.0);
}

TEST(Distances, AreTheSameForAnyNumberOfThreads)
{
    const TriangleMesh mesh = test::room_corner(8, 0.02);
    std::vector<std::vector<double>> results;
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        results.push_back(
            distances(positions(sample_surface(mesh, 5000)), NearestItem(test::room_corner(8, 0.0)), 0.5));
    }
    set_thread_count(0);
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

TEST(RegisterSurface, UndoesASmallMotion)
{
    const TriangleMesh room = test::room_corner(6, 0.0);
    Twist twist;
    twist << 0.01, -0.02, 0.015, 0.01, 0.02, -0.015;
    const Rigid motion = exp_twist(twist);
    const Rigid found = register_surface(sample_surface(moved(room, motion), 3000), room, 0.1);
    EXPECT_TRUE((found * motion).isApprox(Rigid::Identity(), 1e-4));
}

TEST(FitRigid, FindsTheMotionOfThreePoints)
{
    const Rigid motion = Rigid(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(2.0, Vector3d(1, 1, 0).normalized()));
    const std::vector<Vector3d> from{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    std::vector<Vector3d> onto;
    for (const Vector3d& p : from)
        onto.push_back(motion * p);
    EXPECT_TRUE(fit_rigid(from, onto).isApprox(motion, 1e-9));
}

TEST(CompareTrajectories, IgnoresTheChoiceOfWorldAndSeesADrift)
{
    std::vector<Rigid> truth, moved_world, drifted;
    const Rigid elsewhere = Rigid(Eigen::Translation3d(5, 0, 1) * Eigen::AngleAxisd(1.0, Vector3d::UnitZ()));
    for (int i = 0; i < 20; ++i) {
        const double a = 0.3 * i;
        truth.push_back(
            Rigid(Eigen::Translation3d(std::cos(a), std::sin(a), 0.1 * i) * Eigen::AngleAxisd(a, Vector3d::UnitZ())));
        moved_world.push_back(elsewhere * truth.back());
        drifted.push_back(truth.back() * Eigen::Translation3d(0, 0, i % 2 ? 0.01 : -0.01));
    }
    EXPECT_NEAR(compare_trajectories(moved_world, truth).ate, 0.0, 1e-9);
    const TrajectoryError error = compare_trajectories(drifted, truth);
    EXPECT_NEAR(error.ate, 0.01, 2e-4);
    EXPECT_NEAR(error.relative_position, 0.02, 1e-9);
    EXPECT_NEAR(error.relative_rotation, 0.0, 1e-9);
}

} // namespace
} // namespace quoin
