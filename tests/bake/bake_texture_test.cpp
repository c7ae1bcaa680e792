#include "bake/bake_texture.h"

#include "bake/painted_scan.h"
#include "base/parallel.h"
#include "support/expect_error.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

#include <numeric>

namespace quoin {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using test::looking_at;
using test::PaintedScan;

// Smooth enough that bilinear sampling costs less than a grey level, and different everywhere.
Vector3d smooth_paint(const Vector3d& p)
{
    return {128 + 90 * std::sin(5 * p.x() + 2 * p.y()), 128 + 90 * std::sin(6 * p.y() + p.z()),
            128 + 90 * std::cos(4 * p.z() - 3 * p.x())};
}

BakeTextureParams exact_params()
{
    BakeTextureParams params;
    params.format = PageFormat::Png;
    return params;
}

// A room corner of 1 m seen from five places.
std::unique_ptr<PaintedScan> painted_corner(const test::Paint& paint = smooth_paint)
{
    auto scan = std::make_unique<PaintedScan>(room_corner(3), paint);
    for (const Vector3d& eye : {Vector3d(1.3, 1.2, 1.1), Vector3d(1.5, 0.9, 1.0), Vector3d(0.9, 1.5, 1.0),
                                Vector3d(1.1, 1.1, 1.5), Vector3d(1.4, 1.4, 0.8)})
        scan->add_view(looking_at(eye, {0.35, 0.35, 0.35}));
    return scan;
}

TexturedMesh bake(const PaintedScan& scan, const BakeTextureParams& params, const TriangleMesh* dense = nullptr)
{
    const ScanImages images = scan.images();
    return bake_texture({images, scan.keyframes(), scan.planes(), scan.alignment(), dense}, params);
}

struct Texel {
    Vector3d p_world;
    Rgb8 color;
    TexelSource source;
};

// The texels whose centres lie in faces of the textured mesh, at the place that the uv coordinates give them.
std::vector<Texel> texels_of(const TexturedMesh& textured)
{
    std::vector<ColorImage> pages;
    std::vector<ColorImage> sources;
    for (const auto& page : textured.page) {
        pages.push_back(decode_color(page.image, "page"));
        sources.push_back(decode_color(page.source, "source"));
    }
    std::vector<Texel> texels;
    const auto& mesh = textured.planes.mesh;
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        const auto& page = pages[textured.face_page[f]];
        std::array<Eigen::Vector2d, 3> t;
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = textured.uv[textured.corner_uv[f][k]]
                       .cast<double>()
                       .cwiseProduct(Eigen::Vector2d(page.width, page.height))
                       .array() -
                   0.5;
        Eigen::Matrix2d edges;
        edges << t[1] - t[0], t[2] - t[0];
        if (std::abs(edges.determinant()) < 1e-9) continue;
        const Eigen::AlignedBox2d box = Eigen::AlignedBox2d(t[0]).extend(t[1]).extend(t[2]);
        for (int y = static_cast<int>(std::ceil(box.min().y())); y <= box.max().y(); ++y)
            for (int x = static_cast<int>(std::ceil(box.min().x())); x <= box.max().x(); ++x) {
                const Eigen::Vector2d b = edges.inverse() * (Eigen::Vector2d(x, y) - t[0]);
                if (b.minCoeff() < 0.0 || b.sum() > 1.0) continue;
                const Vector3d p =
                    corner(mesh, f, 0) * (1 - b.sum()) + corner(mesh, f, 1) * b.x() + corner(mesh, f, 2) * b.y();
                texels.push_back(
                    {p, page.at(x, y), static_cast<TexelSource>(sources[textured.face_page[f]].at(x, y)[0])});
            }
    }
    return texels;
}

struct Difference {                             // grey levels
    double mean = 0.0, most = 0.0, worst = 0.0; // most: the 99th percentile
    std::size_t count = 0;
};

Difference difference(const std::vector<Texel>& texels, const PaintedScan& scan, TexelSource source)
{
    std::vector<double> found;
    for (const auto& texel : texels) {
        if (texel.source != source) continue;
        const Vector3d paint = scan.paint(texel.p_world);
        for (int c = 0; c < 3; ++c)
            found.push_back(std::abs(paint[c] - texel.color[static_cast<std::size_t>(c)]));
    }
    if (found.empty()) return {};
    std::ranges::sort(found);
    const double sum = std::accumulate(found.begin(), found.end(), 0.0);
    return {sum / static_cast<double>(found.size()), found[found.size() * 99 / 100], found.back(), found.size()};
}

class EveryBlend : public testing::TestWithParam<Blend> {};

TEST_P(EveryBlend, ReproducesASmoothPatternAtTexelCentres)
{
    const auto scan = painted_corner();
    auto params = exact_params();
    params.blend = GetParam();
    const auto d = difference(texels_of(bake(*scan, params)), *scan, TexelSource::Photograph);
    EXPECT_GT(d.count, 100000u);
    EXPECT_LT(d.mean, 0.6);
    EXPECT_LT(d.most, 2.0);
    EXPECT_LT(d.worst, 3.0);
}
std::string name_of(const testing::TestParamInfo<Blend>& blend)
{
    return blend.param == Blend::Mean ? "Mean" : blend.param == Blend::BestView ? "BestView" : "TwoBand";
}
INSTANTIATE_TEST_SUITE_P(BakeTexture, EveryBlend, testing::Values(Blend::Mean, Blend::BestView, Blend::TwoBand),
                         name_of);

TEST(BakeTexture, IsRightToAFractionOfATexel)
{
    // A steep ramp: half a texel (at 300 / m) would shift it by 4 grey levels.
    const auto ramp = [](const Vector3d& p) {
        return Vector3d::Constant(128 + 100 * std::sin(24 * (p.x() + p.y() + p.z()))).eval();
    };
    const auto scan = painted_corner(ramp);
    const auto texels = texels_of(bake(*scan, exact_params()));
    double shift = 0.0, slope2 = 0.0;
    for (const auto& t : texels) {
        if (t.source != TexelSource::Photograph) continue;
        const double slope = 2400 * std::cos(24 * t.p_world.sum());
        shift += (t.color[0] - ramp(t.p_world)[0]) * slope;
        slope2 += slope * slope;
    }
    EXPECT_NEAR(shift / slope2, 0.0, 0.0002) << "[m] along the ramp; half a texel is 0.0017";
}

TEST(BakeTexture, ShowsAllFacesWithUvInsideThePage)
{
    const auto scan = painted_corner();
    const auto textured = bake(*scan, exact_params());
    EXPECT_EQ(textured.corner_uv.size(), scan->planes().mesh.face.size());
    for (const auto& uv : textured.uv) {
        EXPECT_GE(uv.minCoeff(), 0.0f);
        EXPECT_LE(uv.maxCoeff(), 1.0f);
    }
    for (const auto& texel : texels_of(textured))
        EXPECT_NE(texel.source, TexelSource::Empty);
}

TEST(BakeTexture, PutsEveryViewIntoTheCommonExposure)
{
    PaintedScan scan(room_corner(3), smooth_paint);
    int i = 0;
    for (const Vector3d& eye :
         {Vector3d(1.3, 1.2, 1.1), Vector3d(1.5, 0.9, 1.0), Vector3d(0.9, 1.5, 1.0), Vector3d(1.1, 1.1, 1.5)}) {
        scan.add_view(looking_at(eye, {0.35, 0.35, 0.35}), 1.0 + 0.1 * i, 5.0 * i);
        ++i;
    }
    const auto d = difference(texels_of(bake(scan, exact_params())), scan, TexelSource::Photograph);
    EXPECT_LT(d.mean, 0.8);
    EXPECT_LT(d.most, 2.5);
}

TEST(BakeTexture, IgnoresAViewThatDisagrees)
{
    const auto scan = painted_corner();
    PaintedScan wrong(room_corner(3),
                      [](const Vector3d& p) { return (smooth_paint(p) + Vector3d::Constant(60)).eval(); });
    PaintedScan both(room_corner(3), smooth_paint);
    for (const auto& pose : scan->alignment().camera_from_world)
        both.add_view(pose);
    both.add_view(looking_at({1.2, 1.3, 1.2}, {0.35, 0.35, 0.35}), 1.0, -60.0); // recorded 60 too bright,
    auto alignment = both.alignment();
    alignment.bias.back().setZero(); // and the alignment does not know
    const ScanImages images = both.images();
    const auto textured = bake_texture({images, both.keyframes(), both.planes(), alignment}, exact_params());
    EXPECT_LT(difference(texels_of(textured), both, TexelSource::Photograph).mean, 1.5);
}

TEST(BakeTexture, WorksFromOneKeyframe)
{
    PaintedScan scan(room_corner(3), smooth_paint);
    scan.add_view(looking_at({1.3, 1.2, 1.1}, {0.35, 0.35, 0.35}));
    const auto texels = texels_of(bake(scan, exact_params()));
    EXPECT_LT(difference(texels, scan, TexelSource::Photograph).worst, 3.0);
    for (const auto& texel : texels)
        EXPECT_NE(texel.source, TexelSource::Empty);
}

TEST(BakeTexture, TakesColourOfAnotherSizeThanDepth)
{
    PaintedScan scan(room_corner(3), smooth_paint, 1);
    for (const Vector3d& eye : {Vector3d(1.3, 1.2, 1.1), Vector3d(1.5, 0.9, 1.0)})
        scan.add_view(looking_at(eye, {0.35, 0.35, 0.35}));
    const auto d = difference(texels_of(bake(scan, exact_params())), scan, TexelSource::Photograph);
    EXPECT_GT(d.count, 50000u);
    EXPECT_LT(d.most, 3.0);
}

TEST(BakeTexture, OfSaturatedPhotographsIsWhiteAndOfBlackOnesBlack)
{
    for (const double value : {0.0, 255.0}) {
        const auto scan = painted_corner([&](const Vector3d&) { return Vector3d::Constant(value).eval(); });
        const auto texels = texels_of(bake(*scan, exact_params()));
        for (const auto& texel : texels)
            EXPECT_NE(texel.source, TexelSource::Empty);
        EXPECT_LT(difference(texels, *scan, TexelSource::Photograph).worst, 4.0) << "around the corner it is black";
        EXPECT_EQ(difference(texels, *scan, TexelSource::Photograph).most, 0.0);
    }
}

TEST(BakeTexture, TakesNoColourFromPhotographsWhoseDepthIsNotTheirOwn)
{
    PaintedScan scan(room_corner(3), smooth_paint);
    for (const Vector3d& eye : {Vector3d(1.3, 1.2, 1.1), Vector3d(1.5, 0.9, 1.0)}) {
        const Rigid pose = looking_at(eye, {0.35, 0.35, 0.35});
        scan.add_view_with_depth_of(looking_at(eye - Vector3d(0.5, 0.5, 0.5), {0.35, 0.35, 0.35}), pose);
    }
    TriangleMesh dense = scan.planes().mesh;
    dense.color.assign(dense.position.size(), Rgb8{200, 100, 50});
    auto params = exact_params();
    params.dense_radius = 1.0;
    std::size_t from_photographs = 0;
    const auto texels = texels_of(bake(scan, params, &dense));
    for (const auto& texel : texels) {
        from_photographs += texel.source == TexelSource::Photograph ? 1u : 0u;
        EXPECT_NE(texel.source, TexelSource::Empty);
    }
    EXPECT_LT(from_photographs, texels.size() / 100);
    for (const auto& texel : texels_of(bake(scan, params))) // and without anything to lend colour
        EXPECT_NE(texel.source, TexelSource::DenseMesh);
}

double share_of_photographs(const std::vector<Texel>& texels)
{
    const auto count = std::ranges::count(texels, TexelSource::Photograph, &Texel::source);
    return static_cast<double>(count) / static_cast<double>(texels.size());
}

TEST(BakeTexture, ColoursWhatIsSeenNearEdgesOnlyFromPhotographsToo)
{
    const auto scan = painted_corner();
    auto params = exact_params();
    params.edge_margin = 30.0; // a wide rim along the image and the mesh's silhouette
    const auto last = texels_of(bake(*scan, params));
    params.last_views = false;
    const double safe_share = share_of_photographs(texels_of(bake(*scan, params)));
    EXPECT_GT(share_of_photographs(last), safe_share + 0.1);
    EXPECT_LT(difference(last, *scan, TexelSource::Photograph).most, 3.0);
}

// A wall that no camera sees, behind the corner's floor.
PlaneMesh corner_and_hidden_wall()
{
    const Vector3d o = Vector3d::Zero(), x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    return join_sheets({{o, x, y, 3}, {o, y, z, 3}, {o, z, x, 3}, {{0, 0, -1}, 0.5 * y, 0.5 * x, 2}});
}

TEST(BakeTexture, ColoursUnseenFacesFromTheDenseMesh)
{
    PaintedScan scan(corner_and_hidden_wall(), smooth_paint);
    scan.add_view(looking_at({1.3, 1.2, 1.1}, {0.35, 0.35, 0.35}));
    TriangleMesh dense = join_sheets({{{0, 0, -1}, 0.5 * Vector3d::UnitY(), 0.5 * Vector3d::UnitX(), 50}}).mesh;
    dense.color.assign(dense.position.size(), Rgb8{200, 100, 50});
    std::size_t lent = 0;
    for (const auto& texel : texels_of(bake(scan, exact_params(), &dense))) {
        if (texel.p_world.z() > -0.9) continue;
        EXPECT_EQ(texel.source, TexelSource::DenseMesh);
        EXPECT_EQ(texel.color, (Rgb8{200, 100, 50}));
        ++lent;
    }
    EXPECT_GT(lent, 1000u);
}

TEST(BakeTexture, ColoursUnseenFacesFromAllOthersWithoutADenseMesh)
{
    PaintedScan scan(corner_and_hidden_wall(), [](const Vector3d&) { return Vector3d(90, 120, 150); });
    scan.add_view(looking_at({1.3, 1.2, 1.1}, {0.35, 0.35, 0.35}));
    for (const auto& texel : texels_of(bake(scan, exact_params()))) {
        EXPECT_NEAR(texel.color[0], 90, 1);
        EXPECT_NEAR(texel.color[2], 150, 1);
        EXPECT_EQ(texel.source == TexelSource::Filled,
                  texel.p_world.z() < -0.9 || texel.source != TexelSource::Photograph);
    }
}

TEST(BakeTexture, CarriesColoursOverTheBorderOfAPlaneThatNothingShows)
{
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    const auto paint = [](const Vector3d& p) { return Vector3d::Constant(60 + 120 * p.y()).eval(); };
    PaintedScan scan(join_sheets({{Vector3d::Zero(), x, y, 8}, {x - 0.2 * z, y, 0.2 * z, 8}}), paint);
    scan.add_view(looking_at({0.4, 0.5, 1.6}, {0.4, 0.5, 0.0}, y)); // the second sheet faces away
    std::size_t carried = 0;
    for (const auto& texel : texels_of(bake(scan, exact_params()))) {
        if (texel.p_world.z() > -0.001) continue;
        EXPECT_EQ(texel.source, TexelSource::Filled);
        EXPECT_NEAR(texel.color[0], paint(texel.p_world)[0], 20.0) << texel.p_world.transpose();
        ++carried;
    }
    EXPECT_GT(carried, 1000u);
}

// Two halves of a wall, each seen by a camera of its own; the alignment does not know that the second one is brighter.
double step_between_halves(double brighter, double seam_width)
{
    const Vector3d up = Vector3d::UnitZ();
    PaintedScan scan(join_sheets({{{0, 0, 0}, Vector3d::UnitX(), up, 3}, {{1, 0, 0}, Vector3d::UnitX(), up, 3}}),
                     [](const Vector3d&) { return Vector3d(100, 110, 120); });
    scan.add_view(looking_at({0.4, -1.0, 0.5}, {0.4, 0, 0.5}));
    scan.add_view(looking_at({1.6, -1.0, 0.5}, {1.6, 0, 0.5}), 1.0, -brighter);
    auto alignment = scan.alignment();
    alignment.bias.back().setZero();
    auto params = exact_params();
    params.seam_width = seam_width;
    const ScanImages images = scan.images();
    const auto textured = bake_texture({images, scan.keyframes(), scan.planes(), alignment}, params);
    double left = 0.0, right = 0.0, left_count = 0.0, right_count = 0.0;
    for (const auto& texel : texels_of(textured)) {
        const double x = texel.p_world.x() - 1.0;
        if (std::abs(x) > 0.005) continue;
        (x < 0.0 ? left : right) += texel.color[0];
        (x < 0.0 ? left_count : right_count) += 1.0;
    }
    return right / right_count - left / left_count;
}

TEST(BakeTexture, FadesOutAStepOfBrightnessBetweenPlanes)
{
    EXPECT_NEAR(step_between_halves(10.0, 0.0), 10.0, 1.0);
    EXPECT_NEAR(step_between_halves(10.0, 0.2), 0.0, 3.0);
}

TEST(BakeTexture, KeepsAStepThatIsAChangeOfMaterial) { EXPECT_NEAR(step_between_halves(90.0, 0.2), 90.0, 2.0); }

TEST(BakeTexture, GivesTheSameBytesForAnyNumberOfThreads)
{
    const auto scan = painted_corner();
    std::vector<std::vector<std::byte>> pages;
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        pages.push_back(bake(*scan, {}).page[0].image);
    }
    set_thread_count(0);
    EXPECT_EQ(pages[0], pages[1]);
    EXPECT_EQ(pages[0], pages[2]);
}

TEST(BakeTexture, UsesMorePagesWhenOneIsTooSmall)
{
    const auto scan = painted_corner();
    auto params = exact_params();
    params.max_page_size = 256;
    testing::internal::CaptureStderr();
    const auto textured = bake(*scan, params);
    EXPECT_GT(textured.page.size(), 1u);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                testing::HasSubstr("on " + std::to_string(textured.page.size()) + " pages of at most 256 px"));
    EXPECT_LT(difference(texels_of(textured), *scan, TexelSource::Photograph).most, 2.0);
}

TEST(BakeTexture, RefusesArtifactsOfDifferentRuns)
{
    const auto scan = painted_corner();
    auto alignment = scan->alignment();
    alignment.camera_from_world.pop_back();
    const ScanImages images = scan->images();
    EXPECT_THAT(test::error_of(
                    [&] {
                        bake_texture({images, scan->keyframes(), scan->planes(), alignment}, {});
                    },
                    ExitCode::Input),
                testing::HasSubstr("one per keyframe"));
}

} // namespace
} // namespace quoin
