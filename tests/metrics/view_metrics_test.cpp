#include "bake/bake_texture.h"
#include "metrics/painted_figures.h"
#include "metrics/value_of.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using Eigen::Vector3d;
using test::figures_of;
using test::looking_at;
using test::PaintedScan;
using test::value_of;

Vector3d checks(const Vector3d& p)
{
    const bool odd = (std::lround(std::floor(p.x() / 0.1)) + std::lround(std::floor(p.z() / 0.1))) % 2 != 0;
    return Vector3d::Constant(odd ? 180.0 : 90.0);
}

// The planes of its two halves.
PlaneMesh wall()
{
    const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
    return testing_support::join_sheets({{{-0.4, 0, -0.4}, 0.4 * x, 0.8 * z, 2}, {{0, 0, -0.4}, 0.4 * x, 0.8 * z, 2}});
}

Metrics figures_of(const PaintedScan& scan, const PlaneMesh& model)
{
    const ScanImages images = scan.images();
    const TexturedMesh textured = bake_texture({images, scan.keyframes(), model, scan.alignment()}, {});
    return figures_of(scan, images, textured, {});
}

TEST(ViewMetrics, ChargeForPixelsWithADepthThatTheModelLeavesOut)
{
    PaintedScan scan(wall(), checks);
    scan.add_view(looking_at({0, -1.6, 0}, {0, 0, 0}));
    scan.hold_out(looking_at({0.1, -1.5, 0.1}, {0, 0, 0}));
    PlaneMesh half = scan.planes();
    const auto left = static_cast<std::size_t>(std::ranges::count(half.face_plane, PlaneId{0}));
    half.mesh.face.resize(left); // planes come one after the other
    half.face_plane.resize(left);
    const Metrics whole = figures_of(scan, scan.planes()), less = figures_of(scan, half);
    EXPECT_GT(value_of(whole, "views.model.psnr_charged"), value_of(whole, "views.model.psnr") - 1.0);
    EXPECT_GT(value_of(less, "views.model.psnr"), 20.0); // of what it shows
    // Half of the wall is black where 90 and 180 are due: a mean square of (90^2 + 180^2) / 4.
    const double black = 10.0 * std::log10(255.0 * 255.0 / ((90.0 * 90.0 + 180.0 * 180.0) / 4.0));
    EXPECT_NEAR(value_of(less, "views.model.psnr_charged"), black, 0.5);
    EXPECT_NEAR(value_of(less, "views.model.psnr_shown"), black, 0.5);
}

} // namespace
} // namespace quoin
