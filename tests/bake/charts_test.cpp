#include "bake/atlas.h"
#include "bake/charts.h"
#include "bake/triangle_raster.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

#include <numeric>

namespace quoin {
namespace {
using namespace testing_support;
using Eigen::Vector3d;

constexpr double kMinFacing = 0.2;

double signed_uv_area(const TriangleMesh& mesh, const Chart& chart, FaceId f)
{
    const Eigen::Vector2d a = chart.from_world(corner(mesh, f, 0)), b = chart.from_world(corner(mesh, f, 1)),
                          c = chart.from_world(corner(mesh, f, 2));
    return 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
}

std::size_t face_count(const std::vector<Chart>& charts)
{
    return std::accumulate(charts.begin(), charts.end(), std::size_t{0},
                           [](std::size_t n, const Chart& c) { return n + c.face.size(); });
}

// A sheet along x that is folded back over itself, all in one plane cluster.
PlaneMesh folded_sheet()
{
    PlaneMesh mesh = join_sheets(
        {{{0, 0, 0}, Vector3d::UnitX(), Vector3d::UnitY(), 2}, {{1, 0, 0}, {-0.5, 0, 0.1}, Vector3d::UnitY(), 2}});
    std::ranges::fill(mesh.face_plane, PlaneId{0});
    mesh.plane.resize(1);
    return mesh;
}

TEST(Charts, AreOnePerConnectedPieceOfAPlane)
{
    PlaneMesh mesh = join_sheets({{{0, 0, 0}, Vector3d::UnitX(), Vector3d::UnitY(), 3},
                                  {{2, 0, 0}, Vector3d::UnitX(), Vector3d::UnitY(), 3},
                                  {{0, 0, 0}, Vector3d::UnitY(), Vector3d::UnitZ(), 3}});
    for (auto& plane : mesh.face_plane)
        plane = plane == 1 ? 0 : plane; // the first two sheets are one plane
    const auto charts = make_charts(mesh, kMinFacing);
    EXPECT_EQ(charts.size(), 3u);
    EXPECT_EQ(face_count(charts), mesh.mesh.face.size());
}

TEST(Charts, LieInTheirRectangleAndKeepLengths)
{
    PlaneMesh mesh = room_corner(4);
    for (const Chart& chart : make_charts(mesh, kMinFacing)) {
        EXPECT_NEAR(chart.extent.x() * chart.extent.y(), 1.0, 1e-6) << "a unit square fills its rectangle";
        for (const FaceId f : chart.face)
            for (int k = 0; k < 3; ++k) {
                const auto uv = chart.from_world(corner(mesh.mesh, f, k));
                EXPECT_GE(uv.minCoeff(), -1e-6);
                EXPECT_LE((uv - chart.extent).maxCoeff(), 1e-6);
            }
    }
}

TEST(Charts, TakeTheRectangleOfLeastArea)
{
    const Vector3d u = Vector3d(3, 1, 0).normalized() * 2.0, v = Vector3d(-1, 3, 0).normalized() * 0.5;
    const auto charts = make_charts(join_sheets({{{5, 5, 1}, u, v, 3}}), kMinFacing);
    ASSERT_EQ(charts.size(), 1u);
    EXPECT_NEAR(charts[0].extent.x(), 2.0, 1e-5);
    EXPECT_NEAR(charts[0].extent.y(), 0.5, 1e-5);
}

TEST(Charts, NeverTurnAFaceOver)
{
    const PlaneMesh mesh = folded_sheet();
    const auto charts = make_charts(mesh, kMinFacing);
    EXPECT_EQ(charts.size(), 2u) << "the folded part has a chart of its own";
    for (const Chart& chart : charts)
        for (const FaceId f : chart.face)
            EXPECT_LT(signed_uv_area(mesh.mesh, chart, f), 0.0) << "counter-clockwise with v down";
}

TEST(Charts, KeepTheirSenseWhenTurnedByARightAngle)
{
    const PlaneMesh mesh = join_sheets({{{0, 0, 0}, 2.0 * Vector3d::UnitX(), Vector3d::UnitY(), 2}});
    Chart chart = make_charts(mesh, kMinFacing)[0];
    const Vector3d normal = chart.normal();
    turn(chart);
    EXPECT_NEAR((chart.normal() - normal).norm(), 0.0, 1e-12);
    EXPECT_NEAR(chart.extent.x(), 1.0, 1e-6);
    for (const FaceId f : chart.face) {
        EXPECT_LT(signed_uv_area(mesh.mesh, chart, f), 0.0);
        for (int k = 0; k < 3; ++k)
            EXPECT_GE(chart.from_world(corner(mesh.mesh, f, k)).minCoeff(), -1e-6);
    }
}

TEST(Charts, TakeZeroAreaFacesAlong)
{
    PlaneMesh mesh = room_corner(1);
    mesh.mesh.face.push_back({0, 1, 1});
    mesh.face_plane.push_back(0);
    mesh.mesh.face.push_back({0, 0, 0});
    mesh.face_plane.push_back(2);
    const auto charts = make_charts(mesh, kMinFacing);
    EXPECT_EQ(face_count(charts), mesh.mesh.face.size());
    for (const auto& chart : charts)
        EXPECT_TRUE(chart.extent.allFinite() && chart.axis_u.allFinite());
}

TEST(Charts, SplitSheetsThatWouldOverlap)
{
    // A ramp that climbs over its own start, steep but never turned over, by 3 half turns of a helix.
    PlaneMesh mesh;
    mesh.plane.emplace_back();
    const int steps = 48;
    for (int i = 0; i <= steps; ++i) {
        const float a = 3.0f * 3.14159265f * static_cast<float>(i) / steps, h = 0.02f * static_cast<float>(i);
        mesh.mesh.position.emplace_back(std::cos(a), std::sin(a), h);
        mesh.mesh.position.emplace_back(2 * std::cos(a), 2 * std::sin(a), h);
    }
    for (VertexId i = 0; i < steps; ++i) {
        mesh.mesh.face.push_back({2 * i, 2 * i + 1, 2 * i + 3});
        mesh.mesh.face.push_back({2 * i, 2 * i + 3, 2 * i + 2});
        mesh.face_plane.insert(mesh.face_plane.end(), 2, PlaneId{0});
    }
    auto charts = make_charts(mesh, kMinFacing);
    ASSERT_EQ(charts.size(), 1u);
    charts[0].density = 100.0;
    split_overlaps(mesh, charts);
    EXPECT_GE(charts.size(), 2u);
    EXPECT_EQ(face_count(charts), mesh.mesh.face.size());
    for (const Chart& chart : charts) {
        Image<int> covered(800, 800, 0);
        for (const FaceId f : chart.face)
            for_each_texel(chart_triangle(mesh.mesh, chart, f), 800, 800, 0.0,
                           [&](int x, int y, double) { EXPECT_EQ(covered.at(x, y)++, 0); });
    }
}

TEST(Charts, AreCutWhenTheyAreLongerThanAPage)
{
    const PlaneMesh mesh = join_sheets({{{0, 0, 0}, 10.0 * Vector3d::UnitX(), Vector3d::UnitY(), 8}});
    auto charts = make_charts(mesh, kMinFacing);
    charts[0].density = 100.0;
    fit_charts(mesh, charts, 512, 80.0);
    EXPECT_GE(charts.size(), 2u);
    EXPECT_EQ(face_count(charts), mesh.mesh.face.size());
    for (const Chart& chart : charts)
        EXPECT_LE(chart.extent.maxCoeff() * chart.density, 512.0);
}

TEST(Charts, OfOneFaceLongerThanAPageBecomeCoarser)
{
    PlaneMesh mesh = join_sheets({{{0, 0, 0}, 10.0 * Vector3d::UnitX(), Vector3d::UnitY(), 1}});
    mesh.mesh.face.resize(1);
    mesh.face_plane.resize(1);
    auto charts = make_charts(mesh, kMinFacing);
    charts[0].density = 100.0;
    fit_charts(mesh, charts, 512, 80.0);
    ASSERT_EQ(charts.size(), 1u);
    EXPECT_LE(charts[0].extent.maxCoeff() * charts[0].density, 512.0);
    EXPECT_GT(charts[0].density, 45.0);
}

TEST(Atlas, PutsEveryTexelWhereItsFaceIs)
{
    const PlaneMesh mesh = with_noise(room_corner(4), 0.01f);
    auto charts = make_charts(mesh, kMinFacing);
    for (auto& chart : charts)
        chart.density = 100.0;
    const Atlas atlas = lay_out_atlas(mesh, charts, {1, 1024, 1e7, 100.0});
    for (const TexelChart& texels : atlas.chart) {
        const TexelPositions positions(mesh, texels);
        for (int y = 0; y < texels.height(); ++y)
            for (int x = 0; x < texels.width(); ++x) {
                if (!texels.inside.at(x, y)) continue;
                const auto local = texels.face.at(x, y);
                const Vector3d p = positions.world(local, x, y);
                const FaceId f = texels.chart.face[local];
                EXPECT_NEAR((p - corner(mesh.mesh, f, 0)).dot(face_normal(mesh.mesh, f)), 0.0, 1e-6);
                EXPECT_NEAR((texels.texel(p) - Eigen::Vector2d(x, y)).norm(), 0.0, 1e-6);
            }
    }
}

// Which chart owns every texel of the first page; fails where two do.
Image<std::uint32_t> owners(const Atlas& atlas)
{
    Image<std::uint32_t> owner(atlas.page[0].width, atlas.page[0].height, kNoFace);
    for (std::uint32_t c = 0; c < atlas.chart.size(); ++c) {
        const TexelChart& texels = atlas.chart[c];
        for (int y = 0; y < texels.height(); ++y)
            for (int x = 0; x < texels.width(); ++x) {
                if (!texels.owned.test(x / (2 * texels.margin), y / (2 * texels.margin))) continue;
                EXPECT_EQ(owner.at(texels.x + x, texels.y + y), kNoFace);
                owner.at(texels.x + x, texels.y + y) = c;
            }
    }
    return owner;
}

// The texels that a bilinear look-up at p reads in a mip level all belong to the chart.
bool reads_only(const Image<std::uint32_t>& owner, std::uint32_t chart, const Eigen::Vector2d& p, int level)
{
    const int size = 1 << level;
    const Eigen::Vector2d at = p.array() / size - 0.5;
    const auto weight = [](double distance) { return 1.0 - std::abs(distance); };
    for (int j = static_cast<int>(std::floor(at.y())); j <= std::floor(at.y()) + 1; ++j)
        for (int i = static_cast<int>(std::floor(at.x())); i <= std::floor(at.x()) + 1; ++i) {
            if (weight(at.x() - i) * weight(at.y() - j) < 1e-6) continue;
            for (int y = j * size; y < (j + 1) * size; ++y)
                for (int x = i * size; x < (i + 1) * size; ++x)
                    if (!owner.contains(x, y) || owner.at(x, y) != chart) return false;
        }
    return true;
}

TEST(Atlas, KeepsLookUpsInCleanMipLevelsAwayFromOtherCharts)
{
    const PlaneMesh mesh = with_noise(room_corner(4), 0.01f);
    for (const int levels : {1, 2, 3}) {
        auto charts = make_charts(mesh, 0.97); // many small ones
        for (std::size_t c = 0; c < charts.size(); ++c)
            charts[c].density = 90.0 + 7.3 * static_cast<double>(c % 10);
        const Atlas atlas = lay_out_atlas(mesh, charts, {levels, 1024, 1e7, 90.0});
        ASSERT_EQ(atlas.page.size(), 1u);
        const auto owner = owners(atlas);
        int bleeding = 0;
        for (FaceId f = 0; f < mesh.mesh.face.size(); ++f)
            for (int i = 0; i <= 20; ++i)
                for (int j = 0; i + j <= 20; ++j) {
                    const TexelChart& texels = atlas.chart[atlas.face_chart[f]];
                    const Vector3d p = corner(mesh.mesh, f, 0) * (20 - i - j) / 20 + corner(mesh.mesh, f, 1) * i / 20 +
                                       corner(mesh.mesh, f, 2) * j / 20;
                    const Eigen::Vector2d pixel = texels.texel(p).array() + 0.5 + Eigen::Array2d(texels.x, texels.y);
                    for (int level = 0; level <= levels; ++level)
                        bleeding += !reads_only(owner, atlas.face_chart[f], pixel, level);
                }
        EXPECT_EQ(bleeding, 0) << levels << " clean levels, " << atlas.chart.size() << " charts";
    }
}

TEST(Atlas, LowersTheDensityUntilTheTexelsFit)
{
    const PlaneMesh mesh = room_corner(4);
    auto charts = make_charts(mesh, kMinFacing);
    for (auto& chart : charts)
        chart.density = 500.0;
    const Atlas atlas = lay_out_atlas(mesh, charts, {1, 1024, 1e5, 100.0});
    double texels = 0.0;
    for (const auto& page : atlas.page)
        texels += static_cast<double>(page.width) * page.height;
    EXPECT_LE(texels, 1e5);
    EXPECT_GT(texels, 0.75e5);
}

} // namespace
} // namespace quoin
