#include "render/textured.h"

#include "image/image_io.h"
#include "support/expect_error.h"

#include <cmath>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr int kSize = 32;

ColorImage painting()
{
    ColorImage image(kSize, kSize);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x)
            image.at(x, y) = {static_cast<std::uint8_t>(8 * x), static_cast<std::uint8_t>(8 * y),
                              static_cast<std::uint8_t>((x * y) % 256)};
    return image;
}

// A square of 1 m in the plane z = 1 that shows the whole painting, its upper left towards -x, -y; turned about y.
TexturedMesh painted_square(double turn = 0.0)
{
    TexturedMesh mesh;
    const Eigen::AngleAxisd about_y(turn, Vector3d::UnitY());
    for (const auto& p :
         {Vector3d(-0.5, -0.5, 0), Vector3d(0.5, -0.5, 0), Vector3d(0.5, 0.5, 0), Vector3d(-0.5, 0.5, 0)})
        mesh.planes.mesh.position.push_back((about_y * p + Vector3d::UnitZ()).cast<float>());
    mesh.planes.mesh.face = {{0, 2, 1}, {0, 3, 2}};
    mesh.planes.face_plane = {0, 0};
    mesh.planes.plane = {{about_y * -Vector3d::UnitZ(), 1.0}};
    mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.corner_uv = {{0, 2, 1}, {0, 3, 2}};
    mesh.face_page = {0, 0};
    mesh.page = {{kSize, kSize, encode_png(painting()), encode_png(Image<std::uint8_t>(kSize, kSize, 1))}};
    return mesh;
}

// Sees the square of painted_square() exactly.
const Camera kCamera{kSize, kSize, kSize, kSize, 0.5 * (kSize - 1), 0.5 * (kSize - 1)};

TEST(RenderTextured, ShowsEveryTexelInItsPixel)
{
    const TexturedMesh mesh = painted_square();
    const RenderedView view = render_textured(TexturedModel(mesh), kCamera, Rigid::Identity());
    const ColorImage expected = painting();
    for (int y = 0; y + 1 < kSize; ++y)
        for (int x = 0; x + 1 < kSize; ++x) {
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(view.color.at(x, y)[c], expected.at(x, y)[c], 1) << x << " " << y;
            ASSERT_NEAR(view.depth.at(x, y), 1.0f, 1e-5f);
        }
}

TEST(RenderTextured, IsCorrectInPerspective)
{
    const TexturedMesh mesh = painted_square(0.8);
    const Camera camera{321, 241, 300, 300, 160, 120};
    const RenderedView view = render_textured(TexturedModel(mesh), camera, Rigid::Identity(), 2);
    // The painting's red grows by 8 a texel from its left edge, wherever it appears.
    for (const double u : {0.25, 0.5, 0.75}) {
        const Vector3d point =
            Eigen::AngleAxisd(0.8, Vector3d::UnitY()) * Vector3d(u - 0.5, 0.02, 0) + Vector3d::UnitZ();
        const Eigen::Vector2d pixel = camera.project(point);
        const Rgb8 color =
            view.color.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
        EXPECT_NEAR(color[0], 8.0 * (u * kSize - 0.5), 2.5);
    }
}

TEST(RenderTextured, AveragesTheTextureFromFarAway)
{
    const TexturedMesh mesh = painted_square();
    const Camera camera{9, 9, 8, 8, 4, 4};
    Rigid far = Rigid::Identity();
    far.translation().z() = 1.0; // 8 texels a pixel
    const RenderedView view = render_textured(TexturedModel(mesh), camera, far);
    EXPECT_NEAR(view.color.at(4, 4)[0], 8.0 * 15.5, 6.0);
    EXPECT_EQ(view.face.at(0, 0), kNoFace);
    EXPECT_EQ(view.color.at(0, 0), (Rgb8{0, 0, 0}));
}

TEST(RenderColored, BlendsTheColoursOfTheCorners)
{
    TriangleMesh mesh = painted_square().planes.mesh;
    mesh.color = {{0, 0, 0}, {255, 0, 0}, {255, 255, 0}, {0, 255, 0}};
    const RenderedView view = render_colored(mesh, kCamera, Rigid::Identity());
    EXPECT_NEAR(view.color.at(8, 24)[0], 255.0 * 8.5 / kSize, 1.0);
    EXPECT_NEAR(view.color.at(8, 24)[1], 255.0 * 24.5 / kSize, 1.0);
}

TEST(TexturedModel, RefusesAPageOfAnotherSizeThanItSays)
{
    TexturedMesh mesh = painted_square();
    mesh.page[0].width = 64;
    EXPECT_THAT(test::error_of([&] { TexturedModel model(mesh); }, ExitCode::Input), testing::HasSubstr("32x32"));
}

TEST(BarycentricOnRay, IsOneAtItsOwnCorner)
{
    const std::array<Vector3d, 3> t{Vector3d(0, 0, 2), Vector3d(1, 0, 3), Vector3d(0, 1, 4)};
    for (int k = 0; k < 3; ++k)
        EXPECT_TRUE(
            barycentric_on_ray(t, t[static_cast<std::size_t>(k)] * 0.3).isApprox(Vector3d(Vector3d::Unit(k)), 1e-12));
}

} // namespace
} // namespace quoin
