#include "lines/detect_lines.h"

#include "base/parallel.h"
#include "image/image_io.h"
#include "lines/segments.h"
#include "lines/straight_borders.h"
#include "render/rasterize.h"
#include "scan/digest.h"
#include "support/expect_error.h"
#include "support/grids.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>

#include <set>

namespace quoin {
namespace {

constexpr int kSupersampling = 4;
constexpr double kSide = 0.5; // of the box [m]

// A box around the origin on six grids; one plane a side.
PlaneMesh box()
{
    const double h = 0.5 * kSide;
    const Eigen::Vector3d x(kSide, 0, 0), y(0, kSide, 0), z(0, 0, kSide);
    TriangleMesh mesh;
    const int n = 8;
    test::append(mesh, test::grid({-h, -h, h}, x, y, n, n));
    test::append(mesh, test::grid({-h, -h, -h}, y, x, n, n));
    test::append(mesh, test::grid({h, -h, -h}, y, z, n, n));
    test::append(mesh, test::grid({-h, -h, -h}, z, y, n, n));
    test::append(mesh, test::grid({-h, h, -h}, z, x, n, n));
    test::append(mesh, test::grid({-h, -h, -h}, x, z, n, n));
    PlaneMesh result;
    result.mesh = test::welded(mesh);
    for (PlaneId p = 0; p < 6; ++p) {
        const auto f = static_cast<FaceId>(2 * n * n * p);
        const Eigen::Vector3d normal = face_normal(result.mesh, f);
        result.plane.push_back({normal, -normal.dot(corner(result.mesh, f, 0))});
        result.face_plane.insert(result.face_plane.end(), 2 * n * n, p);
    }
    result.moments.resize(6);
    result.vertex_class = classify_vertices(result.mesh, result.face_plane);
    return result;
}

Rigid looking_at_origin(const Eigen::Vector3d& eye)
{
    const Eigen::Vector3d forward = -eye.normalized(),
                          right = Eigen::Vector3d(0, 0, -1).cross(forward).normalized() * -1.0;
    Rigid world_from_camera = Rigid::Identity();
    world_from_camera.linear() << right, forward.cross(right), forward;
    world_from_camera.translation() = eye;
    return world_from_camera.inverse();
}

// What the camera sees, one grey per plane, smooth edges.
ColorImage photograph(const PlaneMesh& mesh, const Camera& camera, const Rigid& camera_from_world)
{
    const double s = kSupersampling;
    const Camera fine{camera.width * kSupersampling, camera.height * kSupersampling, camera.fx * s, camera.fy * s,
                      (camera.cx + 0.5) * s - 0.5,   (camera.cy + 0.5) * s - 0.5};
    const Visibility seen = rasterize(mesh.mesh, fine, camera_from_world);
    const std::array<int, 7> grey{40, 80, 120, 160, 200, 240, 10};
    ColorImage image(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            int sum = 0;
            for (int v = 0; v < kSupersampling; ++v)
                for (int u = 0; u < kSupersampling; ++u) {
                    const FaceId f = seen.face.at(kSupersampling * x + u, kSupersampling * y + v);
                    sum += f == kNoFace ? grey[6] : grey[mesh.face_plane[f]];
                }
            const auto value = static_cast<std::uint8_t>(sum / (kSupersampling * kSupersampling));
            image.at(x, y) = {value, value, value};
        }
    return image;
}

// A scan of `mesh` on disk: colour images only, from a colour camera 5 cm beside the depth camera.
struct TestScan {
    test::TemporaryFolder folder;
    Scan scan;
    Keyframes keyframes;

    TestScan(const PlaneMesh& mesh, const std::vector<Eigen::Vector3d>& eyes)
    {
        scan.color = {.width = 320, .height = 240, .fx = 300, .fy = 305, .cx = 161.3, .cy = 118.2};
        scan.depth = scan.color;
        scan.depth_from_color.translation() = Eigen::Vector3d(0.05, 0.01, 0.0);
        for (const auto& eye : eyes) {
            Frame frame;
            frame.camera_from_world = looking_at_origin(eye);
            scan.frames.push_back(frame);
            const auto id = static_cast<FrameId>(scan.frames.size() - 1);
            const auto png = encode_png(photograph(mesh, scan.color, scan.color_from_world(id)));
            scan.frames[id].color = {fmt::format("{}.png", id), sha256(png)};
            std::ofstream(folder / scan.frames[id].color.name, std::ios::binary)
                .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
            keyframes.frame.push_back(id);
        }
    }
    LineMatches detect(const PlaneMesh& mesh, const DetectLinesParams& params) const
    {
        return detect_lines(ScanImages(scan, folder.path()), keyframes, mesh, params);
    }
    Eigen::Vector2d pixel(FrameId frame, const Eigen::Vector3f& p_world) const
    {
        return scan.color.project(scan.color_from_world(frame) * p_world.cast<double>());
    }
};

double distance_to_line(const Eigen::Vector2d& p, const Eigen::Vector4f& segment)
{
    const Eigen::Vector2d a = segment.head<2>().cast<double>(),
                          along = (segment.tail<2>().cast<double>() - a).normalized();
    return std::abs(along.x() * (p - a).y() - along.y() * (p - a).x());
}

const Eigen::Vector3d kEye(0.7, 0.5, 0.9);
constexpr std::array kMethods{SegmentMethod::Lsd, SegmentMethod::EdLines, SegmentMethod::Guided};

DetectLinesParams of(SegmentMethod method)
{
    DetectLinesParams params;
    params.method = method;
    return params;
}

TEST(DetectLines, RecoversTheVisibleEdgesOfABoxWithinOnePixel)
{
    const PlaneMesh mesh = box();
    const TestScan scan(mesh, {kEye});
    for (const auto method : kMethods) {
        const LineMatches lines = scan.detect(mesh, of(method));
        std::set<std::array<PlaneId, 2>> borders;
        for (const auto& line : lines) {
            borders.insert(line.planes);
            EXPECT_LT(line.planes[0], line.planes[1]);
            EXPECT_LT(line.fit_error, 1.0f);
            for (int end = 0; end < 2; ++end) {
                const Eigen::Vector3f p = line.end_points[static_cast<std::size_t>(end)];
                EXPECT_LT(distance_to_line(scan.pixel(0, p), line.segment), 1.0);
                for (const PlaneId plane : line.planes)
                    EXPECT_NEAR(mesh.plane[plane].signed_distance(p.cast<double>()), 0.0, 1e-5);
                const Eigen::Vector2d own = line.segment.segment<2>(2 * end).cast<double>(),
                                      other = line.segment.segment<2>(2 - 2 * end).cast<double>();
                EXPECT_LT((scan.pixel(0, p) - own).norm(), (scan.pixel(0, p) - other).norm())
                    << "ends are in the segment's order";
            }
        }
        EXPECT_EQ(borders.size(), 9u) << "three inner edges and six of the outline, of twelve";
    }
}

// By pair of planes [m].
std::map<std::array<PlaneId, 2>, double> covered_lengths(const LineMatches& lines)
{
    std::map<std::array<PlaneId, 2>, double> covered;
    for (const auto& line : lines)
        covered[line.planes] += (line.end_points[1] - line.end_points[0]).norm();
    return covered;
}

TEST(DetectLines, OverlapCoversMostOfEachEdge)
{
    const PlaneMesh mesh = box();
    const TestScan scan(mesh, {kEye});
    for (const auto method : kMethods)
        for (const auto& [planes, length] : covered_lengths(scan.detect(mesh, of(method)))) {
            EXPECT_GT(length, 0.85 * kSide);
            EXPECT_LT(length, 1.01 * kSide);
        }
}

// The box with a stripe of another colour, but of the same plane, along every edge of its sides.
PlaneMesh striped_box()
{
    PlaneMesh mesh = box();
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        const Eigen::Vector3d c = (corner(mesh.mesh, f, 0) + corner(mesh.mesh, f, 1) + corner(mesh.mesh, f, 2)) / 3.0;
        const bool inside = (c.cwiseAbs().array() < kSide * (0.5 - 1.0 / 8.0)).count() == 2;
        if (inside) mesh.face_plane[f] = (mesh.face_plane[f] + 3) % 6;
    }
    return mesh;
}

TEST(DetectLines, GivesEveryPartOfABorderToItsNearestSegmentOnly)
{
    const PlaneMesh mesh = box();
    const TestScan scan(striped_box(), {kEye});
    for (const auto method : kMethods) {
        DetectLinesParams params = of(method);
        params.match_distance = 20.0; // further than the stripes are wide
        const auto covered = covered_lengths(scan.detect(mesh, params));
        EXPECT_EQ(covered.size(), 9u);
        for (const auto& [planes, length] : covered)
            EXPECT_LT(length, 1.01 * kSide);
    }
}

TEST(DetectLines, MeasuresHowFarAWrongPoseMovesTheBorders)
{
    const PlaneMesh mesh = box();
    TestScan scan(mesh, {kEye});
    const double shift = 0.012; // [m], about 3 px at this distance
    scan.scan.frames[0].camera_from_world.translation().x() += shift;
    for (const auto method : kMethods) {
        const LineMatches lines = scan.detect(mesh, of(method));
        EXPECT_GE(lines.size(), 7u);
        double worst = 0.0;
        for (const auto& line : lines)
            worst = std::max(worst, static_cast<double>(line.fit_error));
        EXPECT_GT(worst, 1.5);
        EXPECT_LT(worst, 5.0);
        DetectLinesParams strict = of(method);
        strict.match_distance = 1.0;
        EXPECT_LT(scan.detect(mesh, strict).size(), lines.size());
    }
}

TEST(DetectLines, BordersBehindAWallAreNotMatched)
{
    const PlaneMesh mesh = box();
    const TestScan scan(mesh, {kEye}); // photographs show the box ...
    PlaneMesh hidden = mesh;           // ... but a wall stands between in the mesh
    const Eigen::Vector3d side = Eigen::Vector3d::UnitZ().cross(kEye).normalized() * 4.0,
                          up = kEye.cross(side).normalized() * 4.0;
    test::append(hidden.mesh, test::grid(0.6 * kEye - 0.5 * (side + up), side, up, 1, 1));
    hidden.plane.push_back({kEye.normalized(), -0.6 * kEye.norm()});
    hidden.moments.emplace_back();
    hidden.face_plane.insert(hidden.face_plane.end(), 2, 6);
    hidden.vertex_class = classify_vertices(hidden.mesh, hidden.face_plane);
    for (const auto method : kMethods)
        EXPECT_TRUE(scan.detect(hidden, of(method)).empty());
}

TEST(DetectLines, FindsNothingInABlankImageOrWithoutKeyframes)
{
    PlaneMesh mesh = box();
    TestScan blank(mesh, {{0.0, 0.01, -3.0}});
    PlaneMesh far_box = mesh;
    for (auto& p : far_box.mesh.position)
        p.z() -= 50.0f; // behind the camera
    for (const auto method : {SegmentMethod::Lsd, SegmentMethod::EdLines})
        EXPECT_TRUE(detect_segments(GrayImage(64, 48, 0.5f), of(method)).empty());
    for (const auto method : kMethods)
        EXPECT_TRUE(blank.detect(far_box, of(method)).empty());
    blank.keyframes.frame.clear();
    EXPECT_TRUE(blank.detect(mesh, {}).empty());
}

TEST(DetectLines, NamesAKeyframeThatIsNotInTheScan)
{
    const PlaneMesh mesh = box();
    TestScan scan(mesh, {kEye});
    scan.keyframes.frame = {7};
    const std::string message = test::error_of([&] { scan.detect(mesh, {}); }, ExitCode::Input);
    EXPECT_NE(message.find("frame 7"), std::string::npos) << message;
}

TEST(DetectLines, HasTheSameBytesForAnyNumberOfThreads)
{
    const PlaneMesh mesh = box();
    const TestScan scan(mesh, {kEye, {-0.7, 0.6, 0.8}, {0.1, -0.9, 0.7}, {0.9, 0.2, -0.6}, {0.5, 0.9, 0.4}});
    for (const auto method : kMethods) {
        set_thread_count(1);
        const LineMatches one = scan.detect(mesh, of(method));
        EXPECT_GT(one.size(), 20u);
        for (const int threads : {2, 4}) {
            set_thread_count(threads);
            const LineMatches many = scan.detect(mesh, of(method));
            ASSERT_EQ(one.size(), many.size());
            for (std::size_t i = 0; i < one.size(); ++i) {
                EXPECT_EQ(one[i].segment, many[i].segment);
                EXPECT_EQ(one[i].frame, many[i].frame);
                EXPECT_EQ(one[i].end_points, many[i].end_points);
                EXPECT_EQ(one[i].fit_error, many[i].fit_error);
            }
        }
    }
    set_thread_count(0);
}

BorderLimits limits() { return {30.0 * std::numbers::pi / 180.0, 0.1, 0.03, 0.01}; }

TEST(StraightBorders, OfABoxAreItsTwelveEdges)
{
    const auto borders = straight_borders(box(), limits());
    EXPECT_EQ(borders.size(), 12u);
    for (const auto& border : borders)
        EXPECT_NEAR((border.ends[1] - border.ends[0]).norm(), kSide, 1e-6);
}

TEST(StraightBorders, AreCutWhereAClosedBorderBends)
{
    // A bump with a flat top in a floor: one plane pair, a border around a square; the planes are told to be steep.
    PlaneMesh mesh;
    mesh.mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20);
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        const Eigen::Vector3d c = (corner(mesh.mesh, f, 0) + corner(mesh.mesh, f, 1) + corner(mesh.mesh, f, 2)) / 3.0;
        mesh.face_plane.push_back(std::abs(c.x() - 0.5) < 0.25 && std::abs(c.y() - 0.5) < 0.25 ? 1 : 0);
    }
    mesh.plane = {{Eigen::Vector3d::UnitZ(), 0.0}, {Eigen::Vector3d::UnitX(), -0.5}};
    const auto borders = straight_borders(mesh, limits());
    double length = 0.0;
    for (const auto& border : borders) {
        const Eigen::Vector3d along = (border.ends[1] - border.ends[0]).normalized();
        EXPECT_GT(along.cwiseAbs().maxCoeff(), 0.99) << "along a side of the square";
        length += (border.ends[1] - border.ends[0]).norm();
    }
    EXPECT_NEAR(length, 2.0, 0.2);
}

TEST(StraightBorders, GoOnOverSmallGaps)
{
    // A ridge of two strips; in the middle of its crease a sliver of a third plane interrupts it for 2.5 cm.
    PlaneMesh mesh;
    mesh.mesh = test::grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 40, 20);
    for (FaceId f = 0; f < mesh.mesh.face.size(); ++f) {
        const Eigen::Vector3d c = (corner(mesh.mesh, f, 0) + corner(mesh.mesh, f, 1) + corner(mesh.mesh, f, 2)) / 3.0;
        const bool sliver = std::abs(c.x() - 0.5125) < 0.0125 && std::abs(c.y() - 0.5) < 0.05;
        mesh.face_plane.push_back(sliver ? 2 : c.y() < 0.5 ? 0 : 1);
    }
    mesh.plane = {{Eigen::Vector3d::UnitZ(), 0.0}, {Eigen::Vector3d::UnitY(), -0.5}, {Eigen::Vector3d::UnitZ(), 0.0}};
    BorderLimits lengthy = limits();
    lengthy.min_length = 0.9;
    EXPECT_EQ(straight_borders(mesh, lengthy).size(), 1u);
    lengthy.max_gap = 0.02;
    EXPECT_TRUE(straight_borders(mesh, lengthy).empty());
}

TEST(StraightBorders, LeaveOutFlatOnesAndShortOnes)
{
    PlaneMesh mesh = box();
    BorderLimits blunt = limits();
    blunt.min_angle = 95.0 * std::numbers::pi / 180.0; // no |cosine| is below that of 95 degrees
    EXPECT_TRUE(straight_borders(mesh, blunt).empty());
    BorderLimits lengthy = limits();
    lengthy.min_length = 0.6;
    EXPECT_TRUE(straight_borders(mesh, lengthy).empty());
    EXPECT_TRUE(straight_borders({}, limits()).empty());
}

} // namespace
} // namespace quoin
