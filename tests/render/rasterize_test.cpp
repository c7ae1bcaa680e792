#include "render/rasterize.h"

#include "base/parallel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace quoin {
namespace {

constexpr double kFloatTolerance = 2e-6; // relative, of a depth kept as float

Camera small_camera() { return {.width = 80, .height = 60, .fx = 50.0, .fy = 52.0, .cx = 38.7, .cy = 30.2}; }

TriangleMesh mesh_of(std::vector<Eigen::Vector3f> position, std::vector<Face> face)
{
    TriangleMesh mesh;
    mesh.position = std::move(position);
    mesh.face = std::move(face);
    return mesh;
}

// A square of side 2 `half` in the plane z = `z`, facing a camera at the origin.
TriangleMesh square(float z, float half)
{
    return mesh_of({{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}, {{0, 2, 1}, {0, 3, 2}});
}

// Depth and barycentric margin of the ray through a pixel on a triangle (Moeller-Trumbore); negative margin = outside.
struct Hit {
    double z, margin;
};
std::optional<Hit> intersect(const TriangleMesh& mesh, FaceId id, const Eigen::Vector3d& ray,
                             const Rigid& camera_from_world)
{
    const Eigen::Vector3d a = camera_from_world * corner(mesh, id, 0), b = camera_from_world * corner(mesh, id, 1),
                          c = camera_from_world * corner(mesh, id, 2);
    Eigen::Matrix3d m;
    m << a - b, a - c, ray;
    if (std::abs(m.determinant()) < 1e-12) return std::nullopt;
    const Eigen::Vector3d s = m.inverse() * a;
    return Hit{s.z(), std::min({s.x(), s.y(), 1.0 - s.x() - s.y()})};
}

// Compares every pixel to the nearest of all ray hits; pixels within `slack` of an edge may go either way.
void expect_equals_ray_casting(const TriangleMesh& mesh, const Rigid& camera_from_world,
                               const RasterizeOptions& options)
{
    const Camera camera = small_camera();
    const auto seen = rasterize(mesh, camera, camera_from_world, options);
    const double slack = 1e-7;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            double nearest = std::numeric_limits<double>::infinity();
            bool doubtful = false;
            for (FaceId id = 0; id < mesh.face.size(); ++id) {
                const auto hit = intersect(mesh, id, camera.ray({x, y}), camera_from_world);
                if (!hit || hit->z < options.near_plane) continue;
                doubtful |= std::abs(hit->margin) < slack;
                if (hit->margin >= 0.0) nearest = std::min(nearest, hit->z);
            }
            if (doubtful) continue;
            if (std::isinf(nearest)) {
                ASSERT_EQ(seen.face.at(x, y), kNoFace) << x << ", " << y;
                ASSERT_EQ(seen.depth.at(x, y), 0.0f);
            } else {
                ASSERT_NE(seen.face.at(x, y), kNoFace) << x << ", " << y;
                ASSERT_NEAR(seen.depth.at(x, y), nearest, 20 * kFloatTolerance * nearest) << x << ", " << y;
            }
        }
}

TriangleMesh random_triangles(unsigned seed, int count, float z_min, float z_max)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> lateral(-2.0f, 2.0f), depth(z_min, z_max);
    TriangleMesh mesh;
    for (int i = 0; i < 3 * count; ++i)
        mesh.position.emplace_back(lateral(random), lateral(random), depth(random));
    for (VertexId i = 0; i < static_cast<VertexId>(count); ++i)
        mesh.face.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    return mesh;
}

TEST(Rasterize, FindsTheDepthOfAFrontalSquareAtEveryPixel)
{
    const auto seen = rasterize(square(2.0f, 10.0f), small_camera(), Rigid::Identity());
    for (const float z : seen.depth.pixels)
        EXPECT_FLOAT_EQ(z, 2.0f);
}

TEST(Rasterize, LeavesNoHoleWhereTwoTrianglesShareAnEdge)
{
    for (int i = 0; i < 50; ++i) {
        TriangleMesh mesh = square(1.5f + 0.01f * static_cast<float>(i), 9.0f);
        mesh.position.push_back(
            {0.013f * static_cast<float>(i), -0.2f, mesh.position[0].z()}); // a fan about an inner point
        mesh.face = {{0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}};
        const auto seen = rasterize(mesh, small_camera(), Rigid::Identity());
        EXPECT_EQ(std::count(seen.face.pixels.begin(), seen.face.pixels.end(), kNoFace), 0) << i;
    }
}

TEST(Rasterize, CoversThePixelWhoseCentreIsInsideATinyTriangle)
{
    const Camera camera{.width = 5, .height = 5, .fx = 1.0, .fy = 1.0, .cx = 0.0, .cy = 0.0};
    const auto mesh = mesh_of({{1.9f, 2.9f, 1.0f}, {2.2f, 2.95f, 1.0f}, {1.95f, 3.2f, 1.0f}}, {{0, 1, 2}});
    const auto seen = rasterize(mesh, camera, Rigid::Identity());
    EXPECT_EQ(seen.face.at(2, 3), 0u);
    EXPECT_EQ(std::count(seen.face.pixels.begin(), seen.face.pixels.end(), kNoFace), 24);
}

TEST(Rasterize, AgreesWithRayCastingOnRandomTriangles)
{
    for (unsigned seed = 0; seed < 10; ++seed)
        expect_equals_ray_casting(random_triangles(seed, 12, 0.5f, 5.0f), Rigid::Identity(), {});
}

TEST(Rasterize, AgreesWithRayCastingOnTrianglesThatPassBehindTheCamera)
{
    Rigid camera_from_world = Rigid::Identity();
    camera_from_world.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    camera_from_world.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
    for (unsigned seed = 0; seed < 10; ++seed)
        expect_equals_ray_casting(random_triangles(seed, 12, -3.0f, 4.0f), camera_from_world, {});
}

TEST(Rasterize, KeepsAWallOfTwoTrianglesThatPassesBehindTheCamera)
{
    // The wall x = 1, 40 m long, seen by a camera in its middle that looks along it.
    const auto mesh = mesh_of({{1, -9, -20}, {1, 9, -20}, {1, 9, 20}, {1, -9, 20}}, {{0, 1, 2}, {0, 2, 3}});
    const Camera camera = small_camera();
    const auto seen = rasterize(mesh, camera, Rigid::Identity());
    for (int x = 44; x < camera.width; ++x)
        for (int y = 0; y < camera.height; ++y) {
            const double z = camera.fx / (x - camera.cx); // on x = 1
            ASSERT_NEAR(seen.depth.at(x, y), z, 10 * kFloatTolerance * z);
        }
}

TEST(Rasterize, HidesWhatIsNearerThanTheNearPlane)
{
    const auto seen = rasterize(square(0.04f, 10.0f), small_camera(), Rigid::Identity());
    EXPECT_EQ(std::count(seen.face.pixels.begin(), seen.face.pixels.end(), kNoFace), 80 * 60);
}

TEST(Rasterize, GivesTheSmallerFaceIdOnEqualDepth)
{
    TriangleMesh mesh = square(2.0f, 10.0f);
    mesh.face = {{0, 2, 1}, {0, 3, 2}, {0, 2, 1}, {0, 3, 2}};
    const auto seen = rasterize(mesh, small_camera(), Rigid::Identity());
    for (const FaceId id : seen.face.pixels)
        EXPECT_LT(id, 2u);
    std::swap(mesh.face[0], mesh.face[1]);
    const auto swapped = rasterize(mesh, small_camera(), Rigid::Identity());
    for (const FaceId id : swapped.face.pixels)
        EXPECT_LT(id, 2u);
}

TEST(Rasterize, ShowsTheNearerOfTwoSquaresInEitherOrder)
{
    const TriangleMesh near = square(1.0f, 10.0f), far = square(3.0f, 10.0f);
    for (const bool near_first : {true, false}) {
        TriangleMesh both = near_first ? near : far;
        const TriangleMesh& other = near_first ? far : near;
        both.position.insert(both.position.end(), other.position.begin(), other.position.end());
        for (const Face& f : other.face)
            both.face.push_back({f[0] + 4, f[1] + 4, f[2] + 4});
        for (const float z : rasterize(both, small_camera(), Rigid::Identity()).depth.pixels)
            EXPECT_FLOAT_EQ(z, 1.0f);
    }
}

TEST(Rasterize, CullsFacesThatLookAway)
{
    TriangleMesh mesh = square(2.0f, 10.0f);
    const RasterizeOptions options{.cull_back_faces = true};
    EXPECT_NE(rasterize(mesh, small_camera(), Rigid::Identity(), options).face.at(40, 30), kNoFace);
    for (Face& f : mesh.face)
        std::swap(f[0], f[1]);
    EXPECT_EQ(rasterize(mesh, small_camera(), Rigid::Identity(), options).face.at(40, 30), kNoFace);
    EXPECT_NE(rasterize(mesh, small_camera(), Rigid::Identity()).face.at(40, 30), kNoFace);
}

TEST(Rasterize, PassesOverFacesThatAreEdgeOnDegenerateOrNotFinite)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto mesh =
        mesh_of({{0, 0, 1}, {0, 0, 2}, {0, 1, 1}, {nan, 0, 1}, {1, 0, 1}}, {{0, 1, 2}, {0, 0, 4}, {0, 3, 4}});
    const auto seen = rasterize(mesh, small_camera(), Rigid::Identity());
    EXPECT_EQ(std::count(seen.face.pixels.begin(), seen.face.pixels.end(), kNoFace), 80 * 60);
}

TEST(Rasterize, GivesAnEmptyPictureOfAnEmptyMesh)
{
    const auto seen = rasterize({}, small_camera(), Rigid::Identity());
    EXPECT_EQ(std::count(seen.depth.pixels.begin(), seen.depth.pixels.end(), 0.0f), 80 * 60);
}

TEST(Rasterize, GivesTheSameBytesFromManyThreads)
{
    const auto mesh = random_triangles(3, 40, -1.0f, 5.0f);
    const auto expected = rasterize(mesh, small_camera(), Rigid::Identity());
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        std::vector<Visibility> seen(8);
        parallel_for(seen.size(), [&](std::size_t i) { seen[i] = rasterize(mesh, small_camera(), Rigid::Identity()); });
        for (const auto& picture : seen) {
            EXPECT_EQ(picture.face.pixels, expected.face.pixels);
            EXPECT_EQ(picture.depth.pixels, expected.depth.pixels);
        }
    }
    set_thread_count(0);
}

} // namespace
} // namespace quoin
