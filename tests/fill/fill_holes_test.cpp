#include "fill/fill_holes.h"

#include "bake/painted_scan.h"
#include "base/parallel.h"
#include "fill/border_loops.h"
#include "mesh/cleanup.h"
#include "mesh/hygiene.h"
#include "support/expect_error.h"
#include "support/plane_meshes.h"

#include <functional>
#include <gmock/gmock.h>
#include <memory>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector3d;
using namespace testing_support;
using test::looking_at;
using test::PaintedScan;
using testing::Each;

const Vector3d kSize(4.0, 3.0, 2.5); // of the room, z up [m]
constexpr int kCells = 20;           // a side of every wall
enum Wall : PlaneId { kFloor = 0, kCeiling = 1, kFront = 2, kBack = 3, kLeft = 4, kRight = 5 };

// The room seen from inside.
PlaneMesh room(int cells = kCells)
{
    PlaneMesh mesh = box(kSize, cells);
    for (auto& face : mesh.mesh.face)
        std::swap(face[1], face[2]);
    for (auto& plane : mesh.plane)
        plane = plane.flipped();
    return mesh;
}

Vector3d middle(const PlaneMesh& mesh, FaceId f)
{
    return (corner(mesh.mesh, f, 0) + corner(mesh.mesh, f, 1) + corner(mesh.mesh, f, 2)) / 3.0;
}

using Hole = std::function<bool(PlaneId, const Vector3d& middle)>;

PlaneMesh without(const PlaneMesh& mesh, const Hole& is_hole)
{
    PlaneMesh rest = mesh;
    rest.mesh.face.clear();
    rest.face_plane.clear();
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        if (is_hole(mesh.face_plane[f], middle(mesh, f))) continue;
        rest.mesh.face.push_back(mesh.mesh.face[f]);
        rest.face_plane.push_back(mesh.face_plane[f]);
    }
    remove_isolated_vertices(rest.mesh);
    rest.vertex_class = classify_vertices(rest.mesh, rest.face_plane);
    return rest;
}

// A scan of what is really there, from the middle of the room all around.
std::unique_ptr<PaintedScan> scan_of(const PlaneMesh& world)
{
    auto scan =
        std::make_unique<PaintedScan>(world, [](const Vector3d&) -> Vector3d { return Vector3d::Constant(128.0); });
    const Vector3d eye(2.0, 1.5, 1.2);
    for (int i = 0; i < 8; ++i)
        for (const double slope : {-0.6, 0.0, 0.6}) {
            const double turn = 2.0 * std::numbers::pi * i / 8.0;
            scan->add_view(looking_at(eye + Vector3d(0.2 * std::cos(3.0 * turn), 0.2, 0.0),
                                      eye + Vector3d(std::cos(turn), std::sin(turn), slope)));
        }
    return scan;
}

Filled<PlaneMesh> filled(const PlaneMesh& mesh, const PaintedScan& scan, const FillHolesParams& params = {})
{
    return fill_holes({mesh, scan.images(), scan.keyframes(), scan.alignment()}, params);
}

double area_of(const PlaneMesh& mesh)
{
    double area = 0.0;
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f)
        area += face_area(mesh.mesh, f);
    return area;
}

// Closed, and as clean as the room was.
void expect_closed_room(const Filled<PlaneMesh>& result)
{
    const Hygiene hygiene = inspect(result.mesh);
    EXPECT_EQ(hygiene.border_edges, 0u);
    EXPECT_EQ(hygiene.euler_characteristic, 2);
    EXPECT_EQ(hygiene.non_manifold_edges + hygiene.duplicate_faces + hygiene.bow_tie_vertices + hygiene.zero_area_faces,
              0u);
    EXPECT_EQ(hygiene.inconsistent_edges + hygiene.flipped_faces, 0u);
    EXPECT_NEAR(area_of(result.mesh), area_of(room()), 1e-4) << "every face on its plane";
    for (FaceId f = 0; f < result.mesh.mesh.face.size(); ++f)
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(result.mesh.plane[result.mesh.face_plane[f]].signed_distance(corner(result.mesh.mesh, f, k)),
                        0.0, 1e-5);
}

class FillHoles : public testing::Test {
protected:
    inline static std::unique_ptr<PaintedScan> closed_; // of the whole room
    static void SetUpTestSuite() { closed_ = scan_of(room(1)); }
    static void TearDownTestSuite() { closed_.reset(); }
};

// In the front wall, y = 0: 0.6 x 0.5 m.
bool in_wall(PlaneId plane, const Vector3d& p)
{
    return plane == kFront && std::abs(p.x() - 2.0) < 0.3 && std::abs(p.z() - 1.25) < 0.25;
}

TEST_F(FillHoles, ClosesAHoleInAWall)
{
    const PlaneMesh open = without(room(), in_wall);
    ASSERT_EQ(inspect(open).euler_characteristic, 1);
    const Filled<PlaneMesh> result = filled(open, *closed_);
    expect_closed_room(result);
    EXPECT_EQ(result.face_filled.size(), result.mesh.mesh.face.size());
    for (FaceId f = 0; f < result.mesh.mesh.face.size(); ++f) {
        EXPECT_EQ(result.face_filled[f], f < open.mesh.face.size() ? 0 : 1);
        EXPECT_TRUE(result.face_filled[f] == 0 || result.mesh.face_plane[f] == kFront);
    }
    EXPECT_TRUE(std::equal(open.mesh.face.begin(), open.mesh.face.end(), result.mesh.mesh.face.begin()));
}

// A flap of the rim lies folded on the wall, 5 mm in front of it: what would run into it stays open, the rest closes.
TEST_F(FillHoles, FoldsOntoNothingThatWasThere)
{
    PlaneMesh open = without(room(), in_wall);
    const auto loops = border_loops(open);
    ASSERT_EQ(loops.size(), 1u);
    const VertexId a = loops[0].vertex[0], b = loops[0].vertex[1];
    const Vector3d tip = middle(open, loops[0].face[0]) + Vector3d(0.0, 0.005, 0.0);
    open.mesh.position.push_back(tip.cast<float>());
    open.mesh.face.push_back({a, b, static_cast<VertexId>(open.mesh.position.size() - 1)});
    open.face_plane.push_back(static_cast<PlaneId>(open.plane.size()));
    open.plane.push_back(open.plane[kFront].flipped());
    open.moments.emplace_back();
    open.vertex_class = classify_vertices(open.mesh, open.face_plane);
    const Hygiene before = inspect(open);
    ASSERT_EQ(before.folded_pairs, 1u);
    const Filled<PlaneMesh> result = filled(open, *closed_);
    const Hygiene after = inspect(result.mesh);
    EXPECT_EQ(after.folded_pairs, before.folded_pairs);
    EXPECT_EQ(after.flipped_faces + after.bow_tie_vertices + after.disconnected_planes, 0u);
    EXPECT_GT(area_of(result.mesh), area_of(open) + 0.9 * (area_of(room()) - area_of(without(room(), in_wall))));
    EXPECT_LT(after.border_edges, before.border_edges);
}

TEST_F(FillHoles, LeavesAWindowOpenThatRaysPassThrough)
{
    const PlaneMesh open = without(room(), in_wall);
    // Outside there is a wall two metres behind the window.
    PlaneMesh world = open;
    const auto outside = join_sheets({{{-4.0, -2.0, -4.0}, {12.0, 0.0, 0.0}, {0.0, 0.0, 12.0}, 1}});
    const auto shift = static_cast<VertexId>(world.mesh.position.size());
    for (const auto& p : outside.mesh.position)
        world.mesh.position.push_back(p);
    for (const Face& f : outside.mesh.face)
        world.mesh.face.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
    world.face_plane.insert(world.face_plane.end(), outside.mesh.face.size(), kFront);
    const Filled<PlaneMesh> result = filled(open, *scan_of(world));
    EXPECT_EQ(result.mesh.mesh.face, open.mesh.face);
    EXPECT_THAT(result.face_filled, Each(0));
}

TEST_F(FillHoles, ExtendsWallAndFloorToTheirIntersection)
{
    // A strip is missing along the whole foot of the front wall, 15 cm of the floor and 12.5 cm of the wall.
    const PlaneMesh open = without(room(), [](PlaneId plane, const Vector3d& p) {
        return (plane == kFloor && p.y() < 0.15) || (plane == kFront && p.z() < 0.125);
    });
    ASSERT_GT(inspect(open).border_edges, 40u);
    expect_closed_room(filled(open, *closed_));
}

TEST_F(FillHoles, ExtendsAWallAboveAGapInTheMiddleOfIt)
{
    const PlaneMesh open = without(room(), [](PlaneId plane, const Vector3d& p) {
        return std::abs(p.x() - 2.0) < 0.4 && ((plane == kFloor && p.y() < 0.15) || (plane == kFront && p.z() < 0.125));
    });
    expect_closed_room(filled(open, *closed_));
}

TEST_F(FillHoles, RestoresACornerOfThreePlanes)
{
    const PlaneMesh open = without(room(), [](PlaneId, const Vector3d& p) { return p.norm() < 0.2; });
    ASSERT_GT(inspect(open).border_edges, 3u);
    expect_closed_room(filled(open, *closed_));
}

TEST_F(FillHoles, ClosesAroundAPieceThatIsLeftInTheHole)
{
    const PlaneMesh open = without(room(), [](PlaneId plane, const Vector3d& p) {
        const double x = std::abs(p.x() - 2.0), z = std::abs(p.z() - 1.25);
        return plane == kFront && x < 0.6 && z < 0.5 && (x > 0.2 || z > 0.125);
    });
    ASSERT_EQ(inspect(open).components, 2u);
    expect_closed_room(filled(open, *closed_));
}

TEST_F(FillHoles, LeavesOpenWhatHasNoCeiling)
{
    const PlaneMesh open = without(room(), [](PlaneId plane, const Vector3d&) { return plane == kCeiling; });
    EXPECT_EQ(filled(open, *closed_).mesh.mesh.face, open.mesh.face);
}

TEST_F(FillHoles, ClosesABayBehindANarrowMouth)
{
    // Without a ceiling, and with a slot in the front wall that is open at its top, 0.2 m wide and 1 m deep.
    const auto no_ceiling = [](PlaneId plane, const Vector3d&) { return plane == kCeiling; };
    const PlaneMesh open = without(room(), [&](PlaneId plane, const Vector3d& p) {
        return no_ceiling(plane, p) || (plane == kFront && p.x() > 2.0 && p.x() < 2.2 && p.z() > 1.5);
    });
    const PlaneMesh whole = without(room(), no_ceiling);
    ASSERT_GT(inspect(open).border_edges, inspect(whole).border_edges);
    const Filled<PlaneMesh> result = filled(open, *closed_);
    EXPECT_EQ(inspect(result.mesh).border_edges, inspect(whole).border_edges);
    EXPECT_NEAR(area_of(result.mesh), area_of(whole), 1e-4);
    EXPECT_EQ(inspect(result.mesh).non_manifold_edges, 0u);
}

TEST_F(FillHoles, LeavesLargeHolesAndLooseSheetsOpen)
{
    const PlaneMesh open = without(room(), in_wall);
    FillHolesParams params;
    params.max_area = 0.2;
    EXPECT_EQ(filled(open, *closed_, params).mesh.mesh.face, open.mesh.face);
    const PlaneMesh sheet = join_sheets({{{1.0, 1.0, 1.0}, {0.05, 0.0, 0.0}, {0.0, 0.05, 0.0}, 1}});
    EXPECT_EQ(filled(sheet, *closed_).mesh.mesh.face, sheet.mesh.face) << "not from behind";
    params = {};
    params.enabled = false;
    EXPECT_EQ(filled(open, *closed_, params).mesh.mesh.face, open.mesh.face);
}

// A bump of no plane, with its top cut off: six triangles around a ragged ring.
TEST_F(FillHoles, ClosesASmallHoleOfAnyShape)
{
    PlaneMesh mesh;
    constexpr int kSides = 6;
    for (int i = 0; i < kSides; ++i)
        for (const double radius : {0.3, 0.05}) {
            const double turn = 2.0 * std::numbers::pi * i / kSides;
            const double height = radius < 0.1 ? 0.2 + (i % 2 ? 0.03 : 0.0) : 0.0;
            mesh.mesh.position.push_back(
                Vector3d(2.0 + radius * std::cos(turn), 1.5 + radius * std::sin(turn), height).cast<float>());
        }
    for (VertexId i = 0; i < kSides; ++i) {
        const VertexId a = 2 * i, b = 2 * i + 1, c = 2 * ((i + 1) % kSides), d = c + 1;
        for (const Face& face : {Face{a, c, b}, Face{c, d, b}}) {
            mesh.mesh.face.push_back(face);
            mesh.face_plane.push_back(static_cast<PlaneId>(mesh.plane.size()));
            const auto f = static_cast<FaceId>(mesh.mesh.face.size() - 1);
            const Vector3d normal = face_normal(mesh.mesh, f);
            mesh.plane.push_back({normal, -normal.dot(corner(mesh.mesh, f, 0))});
            mesh.moments.push_back(
                triangle_moments(corner(mesh.mesh, f, 0), corner(mesh.mesh, f, 1), corner(mesh.mesh, f, 2)));
        }
    }
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    ASSERT_EQ(border_loops(mesh).size(), 2u);
    FillHolesParams params;
    params.min_views = 1000; // the scanned room has no bump
    const Filled<PlaneMesh> result = filled(mesh, *closed_, params);
    const Hygiene hygiene = inspect(result.mesh);
    EXPECT_EQ(hygiene.border_edges, static_cast<std::size_t>(kSides)) << "the foot stays open";
    EXPECT_EQ(hygiene.euler_characteristic, 1);
    EXPECT_EQ(hygiene.inconsistent_edges, 0u);
}

TEST_F(FillHoles, IsTheSameForAnyNumberOfThreads)
{
    const PlaneMesh open = without(room(), [](PlaneId plane, const Vector3d& p) {
        return in_wall(plane, p) || p.norm() < 0.2 || (plane == kLeft && std::abs(p.z() - 1.0) < 0.2);
    });
    set_thread_count(1);
    const Filled<PlaneMesh> one = filled(open, *closed_);
    for (const int threads : {2, 5}) {
        set_thread_count(threads);
        const Filled<PlaneMesh> many = filled(open, *closed_);
        EXPECT_EQ(many.mesh.mesh.face, one.mesh.mesh.face);
        EXPECT_EQ(many.mesh.mesh.position, one.mesh.mesh.position);
        EXPECT_EQ(many.mesh.face_plane, one.mesh.face_plane);
    }
    set_thread_count(0);
    EXPECT_GT(one.mesh.mesh.face.size(), open.mesh.face.size());
}

TEST_F(FillHoles, RefusesPosesOfAnotherRun)
{
    const PlaneMesh mesh = room(2);
    Alignment alignment = closed_->alignment();
    alignment.camera_from_world.pop_back();
    EXPECT_THAT(test::error_of(
                    [&] {
                        fill_holes({mesh, closed_->images(), closed_->keyframes(), alignment}, {});
                    },
                    ExitCode::Input),
                testing::HasSubstr("one per keyframe"));
}

TEST(BorderLoops, CutsWhereABorderMeetsItself)
{
    // Two squares missing from a sheet that touch in a corner.
    PlaneMesh sheet = join_sheets({{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 4}});
    const PlaneMesh open = without(sheet, [](PlaneId, const Vector3d& p) {
        return (p.x() > 0.25 && p.x() < 0.5 && p.y() > 0.25 && p.y() < 0.5) ||
               (p.x() > 0.5 && p.x() < 0.75 && p.y() > 0.5 && p.y() < 0.75);
    });
    const auto loops = border_loops(open);
    ASSERT_EQ(loops.size(), 3u);
    std::vector<std::size_t> sizes;
    for (const BorderLoop& loop : loops)
        sizes.push_back(loop.vertex.size());
    EXPECT_THAT(sizes, testing::UnorderedElementsAre(16u, 4u, 4u));
}

} // namespace
} // namespace quoin
