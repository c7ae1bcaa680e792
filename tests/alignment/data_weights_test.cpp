#include "alignment/data_weights.h"

#include <gtest/gtest.h>

#include <random>

namespace quoin {
namespace {

constexpr double kSigma = 0.01; // [m], that depths are expected to have

// A wall one metre before the only camera, and its depths with noise of `sigma`.
AlignmentProblem wall_of_depths(const AlignmentScene& scene, double sigma)
{
    std::mt19937 generator(1);
    std::normal_distribution<double> noise; // of 1; of 0 there is none
    std::vector<DepthSample> samples;
    for (int i = 0; i < 4000; ++i)
        samples.push_back(
            {{0.0f, 0.0f, static_cast<float>(1.0 + sigma * noise(generator))}, 0, static_cast<float>(1.0 / kSigma)});
    AlignmentProblem problem{scene, 0, {}, {}, {}, {}, {}, {}, {}, 0.0, given_weights(scene.params), {}, {}, {}, {}};
    problem.depths.add(0, std::move(samples));
    return problem;
}

AlignmentState before_wall()
{
    AlignmentState state;
    state.camera_from_world = {Rigid::Identity()};
    state.plane = {{-Vector3::UnitZ(), 0.0, Vector3::UnitZ()}};
    state.exposure.resize(1);
    return state;
}

TEST(EstimatedWeights, CountDepthsByTheNoiseThatTheyShow)
{
    const PlaneMesh mesh;
    const OptimizeTextureParams params;
    const AlignmentScene scene{mesh, params, {}, {}};
    const DataWeights given = given_weights(params);
    const auto weight = [&](double sigma) {
        return estimated_weights(wall_of_depths(scene, sigma), before_wall()).depth / given.depth;
    };
    EXPECT_NEAR(weight(kSigma), 1.0, 0.05);
    EXPECT_NEAR(weight(0.7 * kSigma), 1.0 / 0.49, 0.1);
    EXPECT_LT(weight(2.0 * kSigma), 0.3);
    EXPECT_EQ(weight(0.01 * kSigma), weight(0.0)); // what is too good to be true
}

TEST(EstimatedWeights, AreThoseGivenWhereNothingIsSeen)
{
    const PlaneMesh mesh;
    const OptimizeTextureParams params;
    const AlignmentScene scene{mesh, params, {}, {}};
    AlignmentProblem nothing = wall_of_depths(scene, 0.0);
    nothing.depths = {};
    const DataWeights weights = estimated_weights(nothing, before_wall()), given = given_weights(params);
    EXPECT_EQ(weights.color, given.color);
    EXPECT_EQ(weights.depth, given.depth);
}

TEST(PlaneWeight, HoldsLargePlanesNoMoreThanThePartThatErrsTogether)
{
    const PlaneMesh mesh;
    const OptimizeTextureParams params;
    const AlignmentScene scene{mesh, params, {}, {}};
    AlignmentProblem problem = wall_of_depths(scene, 0.0);
    problem.lambda_p = 1.0;
    problem.texels.spacing = 0.01;
    const auto hold = [&](double area) {
        const double points = area / (problem.texels.spacing * problem.texels.spacing);
        problem.scatter = {{Vector3::Zero(), Eigen::Matrix3d::Zero(), points}};
        return points * plane_weight(problem, 0);
    };
    const double part = params.shared_area;
    EXPECT_NEAR(hold(0.002 * part) / hold(0.001 * part), 2.0, 0.01);
    EXPECT_NEAR(hold(2000.0 * part) / hold(1000.0 * part), 1.0, 0.01);
    EXPECT_NEAR(hold(1000.0 * part) / hold(part), 2.0, 0.01);
}

} // namespace
} // namespace quoin
