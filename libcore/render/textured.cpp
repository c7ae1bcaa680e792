#include "render/textured.h"

#include "base/error.h"
#include "image/image_io.h"
#include "image/sampling.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kSmallest = 4; // side of the last level [texel]
constexpr Rgb8 kNoColor{128, 128, 128};

Image<std::uint8_t> decode_source(const AtlasPage& page, const std::string& name)
{
    const GrayImage gray = decode_gray(page.source, name);
    if (gray.width != page.width || gray.height != page.height)
        throw InputError(fmt::format("{}: the image has {}x{} pixels, the page says {}x{}", name, gray.width,
                                     gray.height, page.width, page.height));
    Image<std::uint8_t> source(gray.width, gray.height);
    std::transform(gray.pixels.begin(), gray.pixels.end(), source.pixels.begin(),
                   [](float v) { return static_cast<std::uint8_t>(v * 255.0f + 0.5f); });
    return source;
}

TexturePyramid decode_page(const AtlasPage& page, std::size_t index)
{
    const std::string name = fmt::format("texture page {}", index);
    TexturePyramid pyramid;
    pyramid.level.push_back(decode_color(page.image, name));
    const ColorImage& first = pyramid.level[0];
    if (first.width != page.width || first.height != page.height)
        throw InputError(fmt::format("{}: the image has {}x{} pixels, the page says {}x{}", name, first.width,
                                     first.height, page.width, page.height));
    if (!page.source.empty()) pyramid.source = decode_source(page, name + " (source)");
    while (std::min(pyramid.level.back().width, pyramid.level.back().height) >= 2 * kSmallest)
        pyramid.level.push_back(half_size(pyramid.level.back()));
    return pyramid;
}

Vector3f bilinear(const ColorImage& image, double x, double y)
{
    return sample_color(image, std::clamp(x, 0.0, image.width - 1.001), std::clamp(y, 0.0, image.height - 1.001));
}

Camera magnified(const Camera& camera, int factor)
{
    const auto s = static_cast<double>(factor);
    return {camera.width * factor, camera.height * factor,      camera.fx * s,
            camera.fy * s,         (camera.cx + 0.5) * s - 0.5, (camera.cy + 0.5) * s - 0.5};
}

// Colour of the point that a pixel shows of a face.
using Shader = std::function<Vector3f(FaceId, const std::array<Vector3d, 3>& corner_camera, const Vector2d& pixel)>;

RenderedView render(const TriangleMesh& mesh, const Camera& camera, const Rigid& camera_from_world, int supersampling,
                    const Shader& shade)
{
    const Camera fine = magnified(camera, supersampling);
    const Visibility seen = rasterize(mesh, fine, camera_from_world);
    RenderedView view{ColorImage(camera.width, camera.height), DepthImage(camera.width, camera.height),
                      Image<FaceId>(camera.width, camera.height, kNoFace)};
    const auto shade_sample = [&](int x, int y) {
        const FaceId face = seen.face.at(x, y);
        std::array<Vector3d, 3> corner_camera;
        for (int k = 0; k < 3; ++k)
            corner_camera[static_cast<std::size_t>(k)] = camera_from_world * corner(mesh, face, k);
        return shade(face, corner_camera, Vector2d(x, y));
    };
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            Vector3f sum = Vector3f::Zero();
            int count = 0;
            for (int i = 0; i < supersampling * supersampling; ++i) {
                const int fx = x * supersampling + i % supersampling, fy = y * supersampling + i / supersampling;
                if (seen.face.at(fx, fy) == kNoFace) continue;
                if (count++ == 0)
                    view.depth.at(x, y) = seen.depth.at(fx, fy), view.face.at(x, y) = seen.face.at(fx, fy);
                sum += shade_sample(fx, fy);
            }
            if (count == 0) continue;
            for (int c = 0; c < 3; ++c)
                view.color.at(x, y)[static_cast<std::size_t>(c)] =
                    static_cast<std::uint8_t>(std::clamp(sum[c] / static_cast<float>(count) + 0.5f, 0.0f, 255.0f));
        }
    return view;
}

} // namespace

Vector3d barycentric_on_ray(const std::array<Vector3d, 3>& p, const Vector3d& ray)
{
    // The ray meets the plane at ray * t with weights in proportion to the volumes it spans with the edges.
    const Vector3d w(ray.dot(p[1].cross(p[2])), ray.dot(p[2].cross(p[0])), ray.dot(p[0].cross(p[1])));
    const double sum = w.sum();
    return sum != 0.0 ? Vector3d(w / sum) : Vector3d::Constant(1.0 / 3.0);
}

TexturedModel::TexturedModel(const TexturedMesh& mesh) : mesh_(&mesh)
{
    for (std::size_t i = 0; i < mesh.page.size(); ++i)
        pages_.push_back(decode_page(mesh.page[i], i));
}

Vector2d TexturedModel::texel(FaceId face, const Vector3d& weights) const
{
    Vector2d uv = Vector2d::Zero();
    for (int k = 0; k < 3; ++k)
        uv += weights[k] * mesh_->uv[mesh_->corner_uv[face][static_cast<std::size_t>(k)]].cast<double>();
    const AtlasPage& page = mesh_->page[mesh_->face_page[face]];
    return {uv.x() * page.width - 0.5, uv.y() * page.height - 0.5};
}

Vector3f TexturedModel::sample(FaceId face, const Vector2d& texel, double footprint) const
{
    const TexturePyramid& page = pages_[mesh_->face_page[face]];
    const double lod = std::clamp(std::log2(std::max(footprint, 1.0)), 0.0, static_cast<double>(page.level.size() - 1));
    const auto low = static_cast<std::size_t>(lod);
    const auto t = static_cast<float>(lod - static_cast<double>(low));
    const auto from_level = [&](std::size_t l) {
        const double scale = 1.0 / static_cast<double>(1u << l);
        return bilinear(page.level[l], (texel.x() + 0.5) * scale - 0.5, (texel.y() + 0.5) * scale - 0.5);
    };
    return t == 0.0f ? from_level(low) : Vector3f((1.0f - t) * from_level(low) + t * from_level(low + 1));
}

RenderedView render_textured(const TexturedModel& model, const Camera& camera, const Rigid& camera_from_world,
                             int supersampling)
{
    const Camera fine = magnified(camera, supersampling);
    const auto shade = [&](FaceId face, const std::array<Vector3d, 3>& p, const Vector2d& pixel) -> Vector3f {
        const auto texel_at = [&](const Vector2d& at) {
            return model.texel(face, barycentric_on_ray(p, fine.ray(at)));
        };
        const Vector2d here = texel_at(pixel);
        const double across = (texel_at(pixel + Vector2d::UnitX()) - here).norm(),
                     down = (texel_at(pixel + Vector2d::UnitY()) - here).norm();
        return model.sample(
            face, here, std::sqrt(across * down)); // between the blur of the longer side and the aliases of the shorter
    };
    return render(model.mesh().planes.mesh, camera, camera_from_world, supersampling, shade);
}

RenderedView render_colored(const TriangleMesh& mesh, const Camera& camera, const Rigid& camera_from_world,
                            int supersampling)
{
    const Camera fine = magnified(camera, supersampling);
    const auto shade = [&](FaceId face, const std::array<Vector3d, 3>& p, const Vector2d& pixel) {
        const Vector3d weights = barycentric_on_ray(p, fine.ray(pixel));
        Vector3f color = Vector3f::Zero();
        for (int k = 0; k < 3; ++k) {
            const Rgb8& c = mesh.color.empty() ? kNoColor : mesh.color[mesh.face[face][static_cast<std::size_t>(k)]];
            color += static_cast<float>(weights[k]) * Vector3f(c[0], c[1], c[2]);
        }
        return color;
    };
    return render(mesh, camera, camera_from_world, supersampling, shade);
}

} // namespace quoin
