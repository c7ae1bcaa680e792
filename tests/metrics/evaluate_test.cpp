#include "metrics/evaluate.h"

#include "base/parallel.h"
#include "image/image_io.h"
#include "image/sampling.h"
#include "metrics/refine_pose.h"
#include "metrics/value_of.h"
#include "support/expect_error.h"
#include "support/grids.h"

#include <cmath>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using Eigen::Vector3d;
using test::has;
using test::value_of;

// The corner of a room of unit squares in the planes z = 0, x = 0 and y = 0, with its planes.
PlaneMesh corner_model(int n)
{
    PlaneMesh model;
    model.mesh = test::room_corner(n, 0.0);
    model.plane = {{Vector3d::UnitZ(), 0.0}, {Vector3d::UnitX(), 0.0}, {Vector3d::UnitY(), 0.0}};
    for (FaceId f = 0; f < model.mesh.face.size(); ++f)
        model.face_plane.push_back(static_cast<PlaneId>(f / static_cast<FaceId>(2 * n * n)));
    model.moments.resize(3);
    for (FaceId f = 0; f < model.mesh.face.size(); ++f)
        model.moments[model.face_plane[f]] +=
            triangle_moments(corner(model.mesh, f, 0), corner(model.mesh, f, 1), corner(model.mesh, f, 2));
    model.vertex_class = classify_vertices(model.mesh, model.face_plane);
    return model;
}

GroundTruth corner_truth()
{
    const PlaneMesh model = corner_model(4);
    GroundTruth truth;
    truth.mesh = model.mesh;
    for (const Plane& plane : model.plane)
        truth.plane.push_back({"wall", plane, 1.0});
    const Vector3d o = Vector3d::Zero();
    truth.crease = {{{o, Vector3d::UnitY()}, {0, 1}, M_PI / 2, true, true},
                    {{o, Vector3d::UnitX()}, {0, 2}, M_PI / 2, true, true},
                    {{o, Vector3d::UnitZ()}, {1, 2}, M_PI / 2, true, true}};
    for (PlaneId p = 0; p < 3; ++p)
        for (int i = 0; i < 400; ++i) {
            const Vector3d u = Vector3d::Unit((static_cast<int>(p) == 0   ? 0
                                               : static_cast<int>(p) == 1 ? 1
                                                                          : 2)),
                           v = model.plane[p].normal.cross(u);
            const Vector3d at = (0.05 * (i % 20) + 0.025) * u + (0.05 * (i / 20) + 0.025) * Vector3d(v.cwiseAbs());
            truth.sample.push_back({at.cast<float>(), model.plane[p].normal.cast<float>(), {100, 100, 100}, p, 9});
        }
    return truth;
}

EvaluateParams quick()
{
    EvaluateParams params;
    params.samples = 3000;
    return params;
}

TEST(Evaluate, OfTheTruthItselfIsPerfect)
{
    const PlaneMesh model = corner_model(3);
    const GroundTruth truth = corner_truth();
    Evaluated inputs;
    inputs.planes = &model;
    inputs.truth = &truth;
    const Metrics m = evaluate(inputs, quick());
    EXPECT_NEAR(value_of(m, "geometry.accuracy.mean"), 0.0, 1e-3);
    EXPECT_NEAR(value_of(m, "geometry.completeness.p95"), 0.0, 1e-3);
    EXPECT_EQ(value_of(m, "geometry.f_score_5mm"), 1.0);
    EXPECT_EQ(value_of(m, "planes.matched"), 1.0);
    EXPECT_EQ(value_of(m, "planes.pieces"), 1.0);
    EXPECT_NEAR(value_of(m, "planes.normal.median"), 0.0, 1e-3);
    EXPECT_NEAR(value_of(m, "creases.recall"), 1.0, 1e-9);
    EXPECT_NEAR(value_of(m, "creases.precision"), 1.0, 1e-9);
    EXPECT_NEAR(value_of(m, "creases.dihedral.median"), 0.0, 1e-9);
    EXPECT_NEAR(value_of(m, "creases.model_distance.rms"), 0.0, 1e-4);
    EXPECT_NEAR(value_of(m, "creases.straightness.rms"), 0.0, 1e-4);
    EXPECT_EQ(value_of(m, "hygiene.non_manifold_edges"), 0.0);
}

TEST(Evaluate, LeavesClosedHolesOutOfTheDistanceToADenseMeshThatLacksThem)
{
    const PlaneMesh model = corner_model(3);
    TriangleMesh dense = model.mesh;
    const std::size_t scanned = 2 * model.mesh.face.size() / 3; // the last plane is a hole of the dense mesh
    dense.face.resize(scanned);
    Evaluated inputs;
    inputs.planes = &model;
    inputs.dense = &dense;
    EXPECT_GT(value_of(evaluate(inputs, quick()), "geometry.accuracy.rms"), 50.0);
    inputs.face_filled.assign(model.mesh.face.size(), 0);
    std::fill(inputs.face_filled.begin() + static_cast<std::ptrdiff_t>(scanned), inputs.face_filled.end(), 1);
    const Metrics m = evaluate(inputs, quick());
    EXPECT_LT(value_of(m, "geometry.accuracy.rms"), 1e-3);
    EXPECT_NEAR(value_of(m, "size.filled_area"), 1.0, 1e-5);
    inputs.face_filled.pop_back();
    EXPECT_THAT(test::error_of([&] { evaluate(inputs, quick()); }, ExitCode::Input), testing::HasSubstr("53 marks"));
}

TEST(Evaluate, SeesAPlaneThatIsTurnedAndMoved)
{
    PlaneMesh model = corner_model(3);
    const Eigen::AngleAxisd turn(0.01,
                                 Vector3d::UnitX()); // the floor's plane by 0.01 rad about its centre, and 2 mm up
    model.plane[0].normal = turn * Vector3d::UnitZ();
    model.plane[0].offset = -model.plane[0].normal.dot(Vector3d(0.5, 0.5, 0.002));
    GroundTruth truth = corner_truth();
    truth.sample.resize(400); // the floor only
    EvaluateParams params = quick();
    params.align = false;
    Evaluated inputs;
    inputs.planes = &model;
    inputs.truth = &truth;
    const Metrics m = evaluate(inputs, params);
    EXPECT_NEAR(value_of(m, "planes.normal.median"), 0.01 * 180.0 / M_PI, 1e-6);
    EXPECT_NEAR(value_of(m, "planes.offset.median"), 2.0, 1e-3);
}

TEST(Evaluate, MissesACreaseThatTheModelRounds)
{
    PlaneMesh model = corner_model(3);
    for (PlaneId& plane : model.face_plane)
        plane = plane == 1 ? 0 : plane; // floor and one wall are one plane
    const GroundTruth truth = corner_truth();
    EvaluateParams params = quick();
    params.crease_tolerance = 0.001;
    Evaluated inputs;
    inputs.planes = &model;
    inputs.truth = &truth;
    const Metrics m = evaluate(inputs, params);
    EXPECT_NEAR(value_of(m, "creases.recall"), 2.0 / 3.0, 0.01);
    EXPECT_NEAR(value_of(m, "creases.precision"), 1.0, 1e-9);
}

Metrics of_corner(const PlaneMesh& model)
{
    const GroundTruth truth = corner_truth();
    EvaluateParams params = quick();
    params.align = false;
    Evaluated inputs;
    inputs.planes = &model;
    inputs.truth = &truth;
    return evaluate(inputs, params);
}

TEST(Evaluate, FindsCreasesThatAreShiftedStraightButElsewhere)
{
    PlaneMesh model = corner_model(4);
    for (auto& p : model.mesh.position)
        p.x() += 0.002f; // two of the three creases run along other axes
    const Metrics m = of_corner(model);
    EXPECT_NEAR(value_of(m, "creases.model_distance.median"), 2.0, 1e-3);
    EXPECT_NEAR(value_of(m, "creases.model_distance.rms"), 2.0 * std::sqrt(2.0 / 3.0), 1e-3);
    EXPECT_NEAR(value_of(m, "creases.straightness.rms"), 0.0, 1e-3);
}

TEST(Evaluate, FindsCreasesThatZigzagAsFarFromStraightAsTheyAreBent)
{
    const auto of_zigzag = [](float size) {
        PlaneMesh model = corner_model(4);
        for (auto& p : model.mesh.position) // the inner vertices of the crease along y: to one side and to the other
            if (p.x() == 0.0f && p.z() == 0.0f && p.y() > 0.1f && p.y() < 0.9f) p.x() += p.y() == 0.5f ? -size : size;
        return of_corner(model);
    };
    const Metrics small = of_zigzag(0.001f), large = of_zigzag(0.002f);
    const double bend = value_of(small, "creases.straightness.rms");
    EXPECT_GT(bend, 0.2);
    EXPECT_LE(bend, value_of(small, "creases.model_distance.rms") + 1e-6);
    EXPECT_NEAR(value_of(large, "creases.straightness.rms"), 2.0 * bend, 0.01 * bend);
}

TEST(Evaluate, ComparesWithTheDenseMeshWhereThereIsNoTruth)
{
    const PlaneMesh model = corner_model(2);
    TriangleMesh dense = test::room_corner(10, 0.0);
    for (auto& p : dense.position)
        p.z() += 0.004f;
    Evaluated inputs;
    inputs.planes = &model;
    inputs.dense = &dense;
    const Metrics m = evaluate(inputs, quick());
    EXPECT_GT(value_of(m, "geometry.accuracy.mean"), 1.0);
    EXPECT_LT(value_of(m, "geometry.accuracy.p95"), 4.1);
    EXPECT_FALSE(has(m, "planes.matched"));
    EXPECT_NEAR(value_of(m, "size.face_ratio"), 24.0 / 600.0, 1e-12);
}

TEST(Evaluate, ComparesExposuresUpToOneFactor)
{
    Scan scan;
    scan.frames.resize(3);
    Keyframes keyframes;
    keyframes.frame = {0, 1, 2};
    Alignment alignment;
    GroundTruth truth = corner_truth();
    for (int i = 0; i < 3; ++i) {
        const double gain = 1.0 + 0.2 * i;
        truth.exposure.push_back({Vector3d::Constant(gain), Vector3d::Zero()});
        truth.world_from_camera.push_back(Rigid(Eigen::Translation3d(i, i * i, 0)));
        alignment.camera_from_world.push_back(truth.world_from_camera.back().inverse());
        alignment.gain.push_back(Eigen::Vector3f::Constant(static_cast<float>(3.0 / gain)));
        alignment.bias.push_back(Eigen::Vector3f::Zero());
        scan.frames[static_cast<std::size_t>(i)].camera_from_world =
            Rigid(Eigen::Translation3d(i == 1 ? 0.02 : 0.0, 0, 0)) * alignment.camera_from_world.back();
    }
    const PlaneMesh model = corner_model(2);
    Evaluated inputs;
    inputs.scan = &scan, inputs.keyframes = &keyframes, inputs.alignment = &alignment, inputs.planes = &model,
    inputs.truth = &truth;
    const Metrics m = evaluate(inputs, quick());
    EXPECT_NEAR(value_of(m, "exposure.gain_error"), 0.0, 1e-4);
    EXPECT_GT(value_of(m, "exposure.input.gain_error"), 5.0);
    EXPECT_NEAR(value_of(m, "poses.ate"), 0.0, 1e-6);
    EXPECT_GT(value_of(m, "poses.input.ate"), 1.0);
    EXPECT_NEAR(value_of(m, "poses.ate_reduction"), 1.0, 1e-6);
}

TEST(Evaluate, RefusesInputsThatDoNotBelongTogether)
{
    const PlaneMesh model = corner_model(2);
    Scan scan;
    scan.frames.resize(2);
    GroundTruth truth = corner_truth();
    truth.world_from_camera.resize(5, Rigid::Identity());
    Evaluated inputs;
    inputs.planes = &model, inputs.scan = &scan, inputs.truth = &truth;
    EXPECT_THAT(test::error_of([&] { evaluate(inputs, quick()); }, ExitCode::Input),
                testing::HasSubstr("ground truth of 5 frames, scan of 2"));
    EXPECT_THAT(test::error_of([&] { evaluate({}, quick()); }, ExitCode::Usage),
                testing::HasSubstr("nothing to evaluate"));
}

TEST(Evaluate, GivesTheSameFiguresForAnyNumberOfThreads)
{
    PlaneMesh model = corner_model(6);
    test::add_noise(model.mesh, 0.004, 5);
    const GroundTruth truth = corner_truth();
    Evaluated inputs;
    inputs.planes = &model, inputs.dense = &model.mesh, inputs.truth = &truth;
    std::vector<std::string> tables;
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        tables.emplace_back();
        for (const Metric& m : evaluate(inputs, quick()))
            tables.back() += m.name + " " + format_param(m.value) + "\n";
    }
    set_thread_count(0);
    EXPECT_EQ(tables[0], tables[1]);
    EXPECT_EQ(tables[0], tables[2]);
}

TEST(MetricsTable, AlignsNamesAndSaysWhichWayIsBetter)
{
    EXPECT_EQ(metrics_table({{"a.b", "mm", 1.5, Better::Lower}, {"c.longer", "", 3, Better::Higher}}),
              "a.b               1.5000 mm   lower is better\n\nc.longer               3      higher is better\n");
}

// A wavy painting on a bent sheet, so that both brightness and depth hold the pose.
TriangleMesh painted_sheet()
{
    TriangleMesh sheet =
        test::height_field(60, [](double x, double y) { return 0.1 * std::sin(4.0 * x) * std::cos(5.0 * y); });
    for (const auto& p : sheet.position) {
        const auto wave = static_cast<std::uint8_t>(128.0 + 80.0 * std::sin(25.0 * static_cast<double>(p.x())) *
                                                                std::cos(31.0 * static_cast<double>(p.y())));
        sheet.color.push_back({wave, wave, wave});
    }
    return sheet;
}

TEST(RefinePose, BringsAShiftedPoseBack)
{
    const TriangleMesh sheet = painted_sheet();
    const Camera camera{160, 120, 140, 140, 79.5, 59.5};
    Rigid world_from_camera = Rigid::Identity();
    world_from_camera.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix(); // looks down
    world_from_camera.translation() = Vector3d(0.5, 0.5, 1.1);
    const Rigid truth = world_from_camera.inverse();
    const RenderModel render = [&](const Camera& c, const Rigid& pose) { return render_colored(sheet, c, pose, 1); };
    const RenderedView view = render(camera, truth);
    TargetView target{view.color, to_gray(view.color), view.depth, camera, camera, Rigid::Identity()};
    Twist error;
    error << 0.01, -0.008, 0.012, 0.01, -0.008, 0.006;
    const Rigid found = refine_pose(target, render, exp_twist(error) * truth, 4);
    const Twist left = log_twist(found * truth.inverse());
    EXPECT_LT(left.head<3>().norm(), 0.1 * error.head<3>().norm());
    EXPECT_LT(left.tail<3>().norm(), 0.1 * error.tail<3>().norm());
}

} // namespace
} // namespace quoin
