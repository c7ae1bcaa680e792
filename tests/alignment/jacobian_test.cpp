// Every derivative of the alignment against central differences.
#include "alignment/depth_term.h"
#include "alignment/line_term.h"
#include "alignment/photometric.h"
#include "alignment/plane_flow.h"
#include "alignment/plane_term.h"
#include "alignment/pose_prior.h"
#include "image/sampling.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace quoin {
namespace {

constexpr double kMaxRelativeError = 1e-5;

Eigen::VectorXd central_differences(int size, double h, const std::function<double(const Eigen::VectorXd&)>& f)
{
    Eigen::VectorXd derivative(size);
    for (int i = 0; i < size; ++i) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(size, i);
        derivative[i] = (f(step) - f(-step)) / (2.0 * h);
    }
    return derivative;
}

void expect_equal(const Eigen::VectorXd& analytic, const Eigen::VectorXd& numeric, double tolerance = kMaxRelativeError)
{
    ASSERT_EQ(analytic.size(), numeric.size());
    EXPECT_GT(analytic.norm(), 0.0);
    EXPECT_LT((analytic - numeric).norm(), tolerance * numeric.norm()) << analytic.transpose() << "\n"
                                                                       << numeric.transpose();
}

struct Random {
    std::mt19937 generator;
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator); }
    Vector3 vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
    Rigid rigid(double angle, double shift)
    {
        const Vector3 omega = vector(angle);
        return exp_twist(twist(omega, vector(shift)));
    }
};

// One frame that looks along +z at a tilted plane, and a second plane that crosses it.
AlignmentState random_state(Random& random)
{
    AlignmentState state;
    state.camera_from_world = {random.rigid(0.1, 0.2)};
    for (const Vector3& normal : {Vector3(0.1, 0.2, -1.0), Vector3(-0.9, 0.3, -0.4)})
        state.plane.push_back(
            {(normal + random.vector(0.1)).normalized(), random(-0.02, 0.02), Vector3(0, 0, 2) + random.vector(0.2)});
    state.exposure = {{random(0.8, 1.2), random(-0.1, 0.1)}};
    state.color.camera = {.width = 64, .height = 48, .fx = 50.0, .fy = 52.0, .cx = 31.0, .cy = 24.5};
    state.color.color_from_depth = random.rigid(0.05, 0.05);
    return state;
}

constexpr float kSlope = 200.0f / 65536.0f, kDark = 8935.0f / 65536.0f; // up to 65535 / 65536: all held exactly

// A linear image: its bilinear surface is exact everywhere, so differences across pixels are exact too.
GrayImage ramp(int width, int height)
{
    GrayImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = kSlope * static_cast<float>(3 * x + 2 * y) + kDark;
    return image;
}

// Grey of the ramp in double, so that differences are not drowned by the rounding of floats.
double ramp_gray(const AlignmentState& state, const CenteredPlane& plane, const Vector3& p)
{
    const Vector3 x = state.color.color_from_depth * (state.camera_from_world[0] * plane.project(p));
    const Eigen::Vector2d u = state.color.camera.project(x);
    const double slope = static_cast<double>(kSlope), dark = static_cast<double>(kDark);
    return state.exposure[0].gain * (slope * (3 * u.x() + 2 * u.y()) + dark) + state.exposure[0].bias;
}

// What the frame of a state shows of one point of its first plane.
GraySamples sample(const AlignmentState& state, const GrayImage& image, const Vector3& p)
{
    const PlaneMesh mesh;
    const OptimizeTextureParams params;
    AlignmentScene scene{mesh, params, {}, {}};
    scene.images.push_back({{image}, {}});
    Texels texels;
    texels.p_world = {p.cast<float>()};
    texels.plane = {0};
    texels.first_of_plane = {0, 1, 1};
    const Observations observations{{0, 1}, {0}, {0}, {0, 1}, {0}};
    return sample_grays(scene, state, {texels, observations, runs_of(observations, texels)}, 0);
}

// The derivative of the corrected grey along the flow of a step of pose, plane and calibration.
double derivative(const AlignmentState& state, const GraySamples& samples, const Eigen::VectorXd& step)
{
    const PlaneFlow plane = plane_flow(state.color.color_from_depth * state.camera_from_world[0], state.plane[0]);
    const Eigen::Matrix3d F =
        plane.flow(camera_flow(state.color).step(step.head<6>(), step.tail<9>()), step.segment<3>(6));
    const Vector3 r(samples.x[0], samples.y[0], 1.0);
    const Vector3 h(samples.by_x[0], samples.by_y[0], -(samples.by_x[0] * r.x() + samples.by_y[0] * r.y()));
    return state.exposure[0].gain * h.dot(F * r);
}

Eigen::VectorXd derivatives(const AlignmentState& state, const GraySamples& samples)
{
    Eigen::VectorXd result(18);
    for (int i = 0; i < 18; ++i)
        result[i] = derivative(state, samples, Eigen::VectorXd::Unit(18, i));
    return result;
}

AlignmentState moved_by(const AlignmentState& state, const Eigen::VectorXd& step)
{
    AlignmentState result = state;
    result.camera_from_world[0] = moved(state.camera_from_world[0], Twist(step.head<6>()));
    result.plane[0] = state.plane[0].moved(step.segment<3>(6));
    result.color = state.color.moved(step.tail<9>());
    return result;
}

TEST(PlaneFlow, HasTheDerivativeByPosePlaneAndCalibration)
{
    constexpr double kFloatError = 1e-4; // samples are floats
    const GrayImage image = ramp(64, 48);
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random{std::mt19937(seed)};
        const AlignmentState state = random_state(random);
        const Vector3 p = state.plane[0].project(Vector3(0, 0, 2) + random.vector(0.3));
        const GraySamples samples = sample(state, image, p);
        EXPECT_NEAR(state.exposure[0].gain * samples.value[0] + state.exposure[0].bias,
                    ramp_gray(state, state.plane[0], p), 1e-6);
        const auto gray_after = [&](const Eigen::VectorXd& step) {
            const AlignmentState after = moved_by(state, step);
            return ramp_gray(after, after.plane[0], p);
        };
        const Eigen::VectorXd analytic = derivatives(state, samples);
        const Eigen::VectorXd numeric = central_differences(18, 1e-5, gray_after);
        expect_equal(analytic.head<6>(), numeric.head<6>(), kFloatError);
        expect_equal(analytic.segment<3>(6), numeric.segment<3>(6), kFloatError);
        expect_equal(analytic.tail<9>(), numeric.tail<9>(), kFloatError);
    }
}

// A point at distance d of the plane glides along it by -d times the tilt: all that the flow leaves out.
TEST(PlaneFlow, LeavesOutNothingButTheGlideOfPointsOffThePlane)
{
    constexpr double kFloatError = 1e-4; // samples are floats
    const GrayImage image = ramp(64, 48);
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random{std::mt19937(seed)};
        const AlignmentState state = random_state(random);
        const CenteredPlane& plane = state.plane[0];
        const Vector3 on_plane = plane.project(Vector3(0, 0, 2) + random.vector(0.3));
        const double d = random(-0.05, 0.05);
        const Vector3 p = on_plane + d * plane.normal;
        const GraySamples samples = sample(state, image, p);
        const Rigid color_from_world = state.color.color_from_depth * state.camera_from_world[0];
        const double x = samples.x[0], y = samples.y[0], gx = samples.by_x[0], gy = samples.by_y[0];
        const Vector3 by_point = Vector3(gx, gy, -(gx * x + gy * y)) / (color_from_world * on_plane).z();
        Eigen::VectorXd expected = derivatives(state, samples);
        expected.segment<2>(6) -=
            d * state.exposure[0].gain * (color_from_world.linear() * plane.tangents()).transpose() * by_point;
        const auto gray_after = [&](const Eigen::VectorXd& step) {
            const AlignmentState after = moved_by(state, step);
            return ramp_gray(after, after.plane[0], p);
        };
        expect_equal(expected, central_differences(18, 1e-5, gray_after), kFloatError);
    }
}

TEST(PlaneFlow, HasGradientsThatAreItsTranspose)
{
    Random random{std::mt19937(11)};
    const AlignmentState state = random_state(random);
    const CameraFlow camera = camera_flow(state.color);
    const PlaneFlow plane = plane_flow(state.color.color_from_depth * state.camera_from_world[0], state.plane[0]);
    for (int i = 0; i < 20; ++i) {
        const Twist pose = twist(random.vector(1), random.vector(1));
        CalibrationStep calibration;
        calibration << random.vector(1), random.vector(1), random.vector(1);
        const Vector3 by_plane = random.vector(1);
        Eigen::Matrix3d S;
        S << random.vector(1), random.vector(1), random.vector(1);
        const CameraStep gradient = plane.camera_gradient(S);
        const double expected = (S.array() * plane.flow(camera.step(pose, calibration), by_plane).array()).sum();
        EXPECT_NEAR(camera.pose_gradient(gradient).dot(pose) + camera.calibration_gradient(gradient).dot(calibration) +
                        plane.plane_gradient(S).dot(by_plane),
                    expected, 1e-9);
        EXPECT_LT((camera.by_pose() * pose - camera.step(pose, CalibrationStep::Zero()).head<6>()).norm(), 1e-12);
    }
}

TEST(GraySample, HasTheExactDerivativeOfTheSampledSmoothedImage)
{
    GrayImage noise(64, 48);
    std::mt19937 generator(7);
    for (float& value : noise.pixels)
        value = std::uniform_real_distribution<float>(0.0f, 1.0f)(generator);
    const GrayImage image = smooth(noise, 0.8);
    Random random{std::mt19937(1)};
    for (int i = 0; i < 100; ++i) {
        const double x = std::floor(random(1, 60)) + random(0.2, 0.8), y = std::floor(random(1, 45)) + random(0.2, 0.8);
        const GraySample sample = sample_gray(image, x, y);
        EXPECT_NEAR(sample.gx, (sample_gray(image, x + 0.1, y).value - sample_gray(image, x - 0.1, y).value) / 0.2,
                    2e-6);
        EXPECT_NEAR(sample.gy, (sample_gray(image, x, y + 0.1).value - sample_gray(image, x, y - 0.1).value) / 0.2,
                    2e-6);
    }
}

TEST(GraySamples, AreFlatOutsideTheImage)
{
    Random random{std::mt19937(0)};
    AlignmentState state = random_state(random);
    state.camera_from_world[0] = Rigid(Eigen::Translation3d(50.0, 50.0, 0.0)) * state.camera_from_world[0];
    const GrayImage image = ramp(64, 48);
    const GraySamples samples = sample(state, image, {0, 0, 2});
    EXPECT_EQ(derivatives(state, samples).norm(), 0.0);
    EXPECT_TRUE(std::isfinite(samples.value[0]));
}

TEST(DepthRows, HaveTheDerivativeByPoseAndPlane)
{
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random{std::mt19937(seed)};
        const AlignmentState state = random_state(random);
        const CenteredPlane& plane = state.plane[0];
        const Rigid& T = state.camera_from_world[0];
        const Vector3 y = Vector3(0, 0, 2) + random.vector(0.5);
        const DepthRows rows = depth_rows(T, plane, plane.tangents());
        const Eigen::Vector4d y_1 = y.homogeneous();
        const Eigen::VectorXd derivative = rows.derivative * y_1;
        const auto residual = [&](const Rigid& pose, const CenteredPlane& p) {
            return p.signed_distance(pose.inverse() * y);
        };
        EXPECT_NEAR(rows.residual.dot(y_1), residual(T, plane), 1e-12);
        expect_equal(derivative.head<6>(),
                     central_differences(6, 1e-5, [&](const auto& step) { return residual(moved(T, step), plane); }));
        expect_equal(derivative.tail<3>(),
                     central_differences(3, 1e-5, [&](const auto& step) { return residual(T, plane.moved(step)); }));
    }
}

TEST(DepthBlocks, AreTheSumsOverTheirSamplesInUnitsOfSigma)
{
    Random random{std::mt19937(5)};
    const AlignmentState state = random_state(random);
    std::vector<DepthSample> all;
    for (int i = 0; i < 60; ++i) {
        const PlaneId plane = i < 25 ? 0 : 1;
        const Vector3 on_plane = state.plane[plane].project(Vector3(0, 0, 2) + random.vector(0.5));
        const Vector3 y = state.camera_from_world[0] * on_plane + random.vector(0.02);
        all.push_back({y.cast<float>(), plane, static_cast<float>(1.0 / random(0.002, 0.01))});
    }
    DepthSamples samples;
    samples.add(0, all);
    const double huber = 0.7;
    const auto blocks = depth_blocks(state, samples, huber);
    const auto costs = depth_costs(state, samples, huber);
    ASSERT_EQ(blocks.size(), 2u);
    ASSERT_EQ(costs.size(), 2u);
    for (std::size_t b = 0; b < 2; ++b) {
        PairBlock expected;
        double cost = 0.0;
        const PlaneId p = blocks[b].plane;
        const DepthRows rows = depth_rows(state.camera_from_world[0], state.plane[p], state.plane[p].tangents());
        for (const DepthSample& sample : all) {
            if (sample.plane != p) continue;
            const Eigen::Vector4d y = sample.p_camera.cast<double>().homogeneous();
            const double sigma = 1.0 / sample.inverse_sigma, r = rows.residual.dot(y) / sigma;
            const Eigen::Matrix<double, 9, 1> J = rows.derivative * y / sigma;
            expected.H += huber_weight(r, huber) * J * J.transpose();
            expected.g += huber_weight(r, huber) * r * J;
            cost += huber_cost(r, huber);
        }
        EXPECT_LT((blocks[b].H - expected.H).norm(), 1e-9 * expected.H.norm());
        EXPECT_LT((blocks[b].g - expected.g).norm(), 1e-9 * expected.g.norm());
        EXPECT_NEAR(costs[b].cost, cost, 1e-9 * cost);
    }
}

TEST(LineRow, HasTheDerivativeByPoseBothPlanesAndCalibration)
{
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random{std::mt19937(seed)};
        const AlignmentState state = random_state(random);
        const LineObservation line{
            0, {0, 1}, {Eigen::Vector2d(random(0, 60), random(0, 40)), Eigen::Vector2d(random(0, 60), random(0, 40))}};
        for (const std::size_t end : {0, 1}) {
            const LineRow row = line_row(state, line, end);
            const auto residual = [&](const std::function<void(AlignmentState&)>& change) {
                AlignmentState s = state;
                change(s);
                return line_row(s, line, end).residual;
            };
            const auto by_pose = [&](const Eigen::VectorXd& step) {
                return residual(
                    [&](AlignmentState& s) { s.camera_from_world[0] = moved(s.camera_from_world[0], step); });
            };
            const auto by_calibration = [&](const Eigen::VectorXd& step) {
                return residual([&](AlignmentState& s) { s.color = s.color.moved(step); });
            };
            expect_equal(row.pose, central_differences(6, 1e-5, by_pose));
            expect_equal(row.calibration, central_differences(9, 1e-5, by_calibration));
            for (const std::size_t i : {0, 1}) {
                const auto by_plane = [&](const Eigen::VectorXd& step) {
                    return residual([&](AlignmentState& s) { s.plane[i] = s.plane[i].moved(step); });
                };
                expect_equal(row.plane[i], central_differences(3, 1e-5, by_plane));
            }
        }
    }
}

// The image of the point at `along` [m] on the line in which the first two planes meet.
Eigen::Vector2d crease_pixel(const AlignmentState& state, double along)
{
    const Plane a = state.plane[0].plane(), b = state.plane[1].plane();
    Eigen::Matrix3d normals;
    normals << a.normal.transpose(), b.normal.transpose(), a.normal.cross(b.normal).transpose();
    const Vector3 p_world = normals.inverse() * Vector3(-a.offset, -b.offset, along);
    return state.color.camera.project(state.color.color_from_depth * (state.camera_from_world[0] * p_world));
}

TEST(LineRow, IsZeroForTheProjectionOfAPointOnBothPlanes)
{
    Random random{std::mt19937(3)};
    const AlignmentState state = random_state(random);
    const LineObservation line{0, {0, 1}, {crease_pixel(state, 0.1), Eigen::Vector2d(0, 0)}};
    EXPECT_NEAR(line_row(state, line, 0).residual, 0.0, 1e-9);
}

TEST(LinesWithin, LeavesOutThoseOfWhichAnEndIsFartherFromTheCrease)
{
    Random random{std::mt19937(3)};
    const AlignmentState state = random_state(random);
    const Eigen::Vector2d p = crease_pixel(state, 0.1), q = crease_pixel(state, 0.3);
    const Eigen::Vector2d along = (q - p).normalized(), across(-along.y(), along.x());
    const auto line = [&](double at_p, double at_q) {
        return LineObservation{0, {0, 1}, {p + at_p * across, q + at_q * across}};
    };
    const auto kept = lines_within({line(0, 0), line(2, 4), line(-2.9, 2.9), line(-4, 0), line(9, 9)}, state, 3.0);
    ASSERT_EQ(kept.size(), 2u);
    EXPECT_EQ(kept[0].end[0], line(0, 0).end[0]);
    EXPECT_EQ(kept[1].end[0], line(-2.9, 2.9).end[0]);
}

TEST(PlaneBlock, HasTheGradientOfTheSumOverPointsAndAPositiveMatrix)
{
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random{std::mt19937(seed)};
        std::vector<Vector3> points(40);
        PlaneScatter scatter;
        for (auto& p : points)
            p = {random(-1, 1), random(-2, 2), random(-0.1, 0.1)};
        for (const auto& p : points)
            scatter.center += p / 40.0;
        for (const auto& p : points)
            scatter.scatter += (p - scatter.center) * (p - scatter.center).transpose();
        scatter.weight = 40.0;
        const CenteredPlane plane{(Vector3(0, 0, 1) + random.vector(0.2)).normalized(), 0.05,
                                  scatter.center + random.vector(0.3)};
        const auto cost = [&](const Eigen::VectorXd& step) {
            double sum = 0.0;
            const CenteredPlane other = plane.moved(step);
            for (const auto& p : points)
                sum += std::pow(other.signed_distance(p), 2);
            return sum;
        };
        const PlaneBlock block = plane_block(scatter, plane);
        EXPECT_NEAR(block.cost, cost(Vector3::Zero()), 1e-9);
        expect_equal(block.g, 0.5 * central_differences(3, 1e-5, cost));
        EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block.H).eigenvalues().minCoeff(), -1e-9);
    }
}

TEST(PlaneScatters, OfMomentsAndOfTexelsAgreeOnADenselySampledPlane)
{
    PlaneMesh mesh;
    mesh.mesh.position = {{0, 0, 1}, {2, 0, 1.1f}, {0, 1, 1.2f}};
    mesh.mesh.face = {{0, 1, 2}};
    mesh.face_plane = {0};
    mesh.moments = {triangle_moments({0, 0, 1}, {2, 0, 1.1}, {0, 1, 1.2})};
    mesh.plane = {fit_plane(mesh.moments[0])};
    const double spacing = 0.01;
    const auto exact = scatters_of_moments(mesh, spacing)[0],
               sampled = scatters_of_texels(sample_texels(mesh, spacing))[0];
    EXPECT_NEAR(sampled.weight / exact.weight, 1.0, 0.02);
    EXPECT_LT((sampled.center - exact.center).norm(), 0.01);
    EXPECT_LT((sampled.scatter - exact.scatter).norm(), 0.05 * exact.scatter.norm());
}

TEST(PriorBlock, HasTheGradientOfTheSquaredLogarithm)
{
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random{std::mt19937(seed)};
        const Rigid input = random.rigid(2.0, 3.0), T = random.rigid(0.05, 0.1) * input;
        const PosePrior prior = pose_prior(0.02, 0.05);
        const auto cost = [&](const Eigen::VectorXd& step) {
            return prior_block(prior, exp_twist(step) * T, input).cost;
        };
        expect_equal(prior_block(prior, T, input).g, 0.5 * central_differences(6, 1e-5, cost));
    }
}

} // namespace
} // namespace quoin
