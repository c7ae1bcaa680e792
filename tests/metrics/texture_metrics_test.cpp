#include "bake/bake_texture.h"
#include "metrics/painted_figures.h"
#include "metrics/value_of.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using Eigen::Vector3d;
using test::figures_of;
using test::has;
using test::looking_at;
using test::PaintedScan;
using test::value_of;

Metrics figures_of(const PaintedScan& scan, const TexturedMesh& textured)
{
    EvaluateParams params;
    params.samples = 20000;
    return figures_of(scan, scan.images(), textured, params);
}

Metrics figures_of(const PaintedScan& scan, const BakeTextureParams& baking = {})
{
    const ScanImages images = scan.images();
    return figures_of(scan, bake_texture({images, scan.keyframes(), scan.planes(), scan.alignment()}, baking));
}

Vector3d gray(const Vector3d&) { return Vector3d::Constant(128); }

// A wall in the plane y = 0 that faces a camera 1 m away, and one of half its area behind it, out of sight.
PlaneMesh wall_and_hidden_wall()
{
    const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
    return testing_support::join_sheets(
        {{{-0.4, 0, -0.4}, 0.8 * x, 0.8 * z, 2}, {{-0.4, 1, -0.2}, 0.8 * x, 0.4 * z, 2}});
}
const Rigid kFacing = looking_at({0, -1.6, 0}, {0, 0, 0});

TEST(TextureMetrics, CountAsSeenWhatIsNotHiddenByTheMesh)
{
    PaintedScan scan(wall_and_hidden_wall(), gray);
    scan.add_view(kFacing);
    EXPECT_NEAR(value_of(figures_of(scan), "texture.seen"), 2.0 / 3.0, 0.001);
}

TEST(TextureMetrics, CountAsSeenWhatTheBakingTurnsDownByItsMargins)
{
    PaintedScan scan(wall_and_hidden_wall(), gray);
    scan.add_view(looking_at({0, -0.4, 0}, {0, 0, 0})); // the wall fills the image: 0.43 m x 0.32 m
    BakeTextureParams baking;
    baking.last_views = false;
    baking.edge_margin = 20.0;
    const Metrics strict = figures_of(scan, baking);
    const double seen = value_of(strict, "texture.seen"), of_seen = value_of(strict, "texture.photograph_of_seen");
    EXPECT_NEAR(seen, 0.43 * 0.32 / 0.96, 0.003);
    EXPECT_NEAR(of_seen, 280.0 / 320.0 * 200.0 / 240.0, 0.02);
    EXPECT_NEAR(value_of(strict, "texture.photograph"), of_seen * seen, 0.003);
    baking.last_views = true;
    EXPECT_GT(value_of(figures_of(scan, baking), "texture.photograph_of_seen"), 0.96);
}

TEST(TextureMetrics, CountNothingAsSeenThatTheMeasuredDepthContradicts)
{
    PaintedScan scan(wall_and_hidden_wall(), gray);
    scan.add_view_with_depth_of(looking_at({0, -1.0, 0}, {0, 0, 0}), kFacing);
    const Metrics metrics = figures_of(scan);
    EXPECT_EQ(value_of(metrics, "texture.seen"), 0.0);
    EXPECT_FALSE(has(metrics, "texture.photograph_of_seen"));
}

// Two sheets side by side, each painted evenly on its half of one page.
TexturedMesh two_gray_sheets(std::uint8_t left, std::uint8_t right, TexelSource source)
{
    const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
    TexturedMesh textured;
    textured.planes = testing_support::join_sheets({{Vector3d::Zero(), x, z, 2}, {x, x, z, 2}});
    ColorImage image(64, 64, Rgb8{left, left, left});
    for (int y = 0; y < 64; ++y)
        std::fill_n(image.row(y) + 32, 32, Rgb8{right, right, right});
    const Image<std::uint8_t> sources(64, 64, static_cast<std::uint8_t>(source));
    textured.page = {{64, 64, encode_png(image), encode_png(sources)}};
    const TriangleMesh& mesh = textured.planes.mesh;
    const auto vertices = static_cast<std::uint32_t>(mesh.position.size());
    for (const float start : {4.0f, 36.0f}) // texels right of the page's left side
        for (const auto& p : mesh.position)
            textured.uv.emplace_back((start + 24.0f * (p.x() - (start > 32.0f ? 1.0f : 0.0f))) / 64.0f,
                                     (4.0f + 24.0f * p.z()) / 64.0f);
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        const std::uint32_t shift = textured.planes.face_plane[f] * vertices;
        textured.corner_uv.push_back({mesh.face[f][0] + shift, mesh.face[f][1] + shift, mesh.face[f][2] + shift});
        textured.face_page.push_back(0);
    }
    return textured;
}

TEST(TextureMetrics, MeasureTheContrastBetweenPlanesButNotInside)
{
    const TexturedMesh textured = two_gray_sheets(100, 107, TexelSource::Photograph);
    Evaluated inputs;
    inputs.textured = &textured;
    const Metrics metrics = evaluate(inputs, {});
    EXPECT_NEAR(value_of(metrics, "texture.border_contrast"), 7.0, 1e-3);
    EXPECT_NEAR(value_of(metrics, "texture.inner_contrast"), 0.0, 1e-3);
    EXPECT_NEAR(value_of(metrics, "texture.density"), 24.0, 1e-3);
    EXPECT_NEAR(value_of(metrics, "texture.atlas_use"), 2.0 * 24.0 * 24.0 / (64.0 * 64.0), 1e-6);
}

TEST(TextureMetrics, MeasureNoStepsOfColoursThatAreNoPhotographs)
{
    const TexturedMesh textured = two_gray_sheets(100, 107, TexelSource::DenseMesh);
    Evaluated inputs;
    inputs.textured = &textured;
    const Metrics metrics = evaluate(inputs, {});
    EXPECT_FALSE(has(metrics, "texture.border_contrast"));
    EXPECT_EQ(value_of(metrics, "texture.dense_mesh"), 1.0);
}

// The figures of such sheets by photographs of two exposures that show 100 to the left and 150 to the right.
Metrics figures_by_photographs_of_100_and_150(const TexturedMesh& textured)
{
    PaintedScan scan(textured.planes,
                     [](const Vector3d& p) { return Vector3d::Constant(p.x() < 1.0 ? 100.0 : 150.0); });
    scan.add_view(looking_at({1.0, -2.5, 0.5}, {1.0, 0.0, 0.5}), 2.0, -20.0);
    scan.add_view(looking_at({0.7, -2.4, 0.5}, {1.0, 0.0, 0.5}), 0.8, 5.0);
    return figures_of(scan, textured);
}
constexpr double kHalfLevelOfDarkPhotograph = 1.0;

TEST(TextureMetrics, TakeNoTrueChangeOfColourForAStepThatTheBakingAdded)
{
    const Metrics metrics = figures_by_photographs_of_100_and_150(two_gray_sheets(100, 150, TexelSource::Photograph));
    EXPECT_NEAR(value_of(metrics, "texture.border_contrast"), 50.0, 1e-3);
    EXPECT_NEAR(value_of(metrics, "texture.border_step"), 0.0, kHalfLevelOfDarkPhotograph);
}

TEST(TextureMetrics, MeasureTheStepThatTheBakingAddedToATrueChangeOfColour)
{
    const Metrics metrics = figures_by_photographs_of_100_and_150(two_gray_sheets(100, 160, TexelSource::Photograph));
    EXPECT_NEAR(value_of(metrics, "texture.border_contrast"), 60.0, 1e-3);
    EXPECT_NEAR(value_of(metrics, "texture.border_step"), 10.0, kHalfLevelOfDarkPhotograph);
    EXPECT_NEAR(value_of(metrics, "texture.inner_step"), 0.0, kHalfLevelOfDarkPhotograph);
}

TEST(TextureMetrics, MeasureNoStepBetweenPlanesOfWhatNoKeyframeSees)
{
    PaintedScan scan(two_gray_sheets(0, 0, TexelSource::Photograph).planes, gray);
    scan.add_view(looking_at({1.0, 2.5, 0.5}, {1.0, 0.0, 0.5})); // from behind
    const Metrics metrics = figures_of(scan, two_gray_sheets(100, 160, TexelSource::Photograph));
    EXPECT_FALSE(has(metrics, "texture.border_step"));
}

TEST(TextureMetrics, TakeNoDetailAtABorderForAStepThatTheBakingAdded)
{
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    PaintedScan scan(testing_support::join_sheets({{Vector3d::Zero(), x, z, 2}, {x, -y, z, 2}}), [](const Vector3d& p) {
        return Vector3d::Constant(128.0 + 100.0 * std::sin(12.0 * (p.x() - 2.0 * p.y() + p.z())));
    });
    scan.add_view(looking_at({0.2, -1.2, 0.5}, {0.9, -0.1, 0.5}));
    scan.add_view(looking_at({0.3, -1.0, 0.6}, {0.9, -0.1, 0.5}));
    const Metrics metrics = figures_of(scan);
    EXPECT_GT(value_of(metrics, "texture.border_contrast"), 4.0);
    EXPECT_LT(value_of(metrics, "texture.border_step"), 1.0);
}

} // namespace
} // namespace quoin
