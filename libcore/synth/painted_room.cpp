#include "synth/painted_room.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "image/sampling.h"
#include "synth/lighting.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr int kLevels = 6;
constexpr int kMargin = 2;     // texels around what is seen
constexpr float kGlow = 1.05f; // light on what gives light itself

const Finish& finish_of(const Room& room, std::uint32_t surface)
{
    return surface < room.planar.size() ? room.planar[surface].finish
                                        : room.curved[surface - room.planar.size()].finish;
}

std::vector<TextureExtent> texture_extents(const std::vector<Facet>& facets, std::size_t surfaces)
{
    const double inf = std::numeric_limits<double>::infinity();
    std::vector<TextureExtent> extents(surfaces, {Vector2d::Constant(inf), Vector2d::Constant(-inf)});
    for (const Facet& facet : facets)
        for (const Vector2d& uv : facet.uv) {
            extents[facet.surface].low = extents[facet.surface].low.cwiseMin(uv);
            extents[facet.surface].high = extents[facet.surface].high.cwiseMax(uv);
        }
    return extents;
}

// Sizes are multiples of 2^(levels - 1), so that texels of all levels line up.
SurfaceTexture empty_texture(const TextureExtent& extent, double texel)
{
    SurfaceTexture texture{extent.low - Vector2d::Constant(kMargin * texel), texel, {}};
    const auto padded = [&](double length) {
        constexpr int block = 1 << (kLevels - 1);
        return (static_cast<int>(std::ceil(length / texel)) + 2 * kMargin + block - 1) / block * block;
    };
    const Vector2d size = extent.high - extent.low;
    texture.levels.emplace_back(padded(size.x()), padded(size.y()));
    return texture;
}

// Mean of the decal over a texel: four samples.
Vector3f decal_color(const Decal& decal, const Vector2d& uv, double texel)
{
    Vector3f sum = Vector3f::Zero();
    for (const double dx : {-0.25, 0.25})
        for (const double dy : {-0.25, 0.25}) {
            const Vector2d at = (uv + texel * Vector2d(dx, dy) - decal.corner).cwiseQuotient(decal.size);
            const double x = std::clamp(at.x() * decal.image.width - 0.5, 0.0, decal.image.width - 1.001);
            const double y = std::clamp(at.y() * decal.image.height - 0.5, 0.0, decal.image.height - 1.001);
            sum += sample_color(decal.image, x, y);
        }
    return sum / (4.0f * 255.0f);
}

Vector3f surface_albedo(const Finish& finish, const Vector2d& uv, double texel)
{
    for (auto decal = finish.decals.rbegin(); decal != finish.decals.rend(); ++decal) {
        const Vector2d at = uv - decal->corner;
        if ((at.array() >= 0.0).all() && (at.array() <= decal->size.array()).all())
            return decal_color(*decal, uv, texel).cwiseMin(0.92f);
    }
    return albedo(finish.material, uv);
}

void paint_rows(SurfaceTexture& texture, const Finish& finish, const LightGrid& light, int begin, int end)
{
    ColorImage& image = texture.levels[0];
    for (int y = begin; y < end; ++y)
        for (int x = 0; x < image.width; ++x) {
            const Vector2d uv = texture.corner + texture.texel * Vector2d(x + 0.5, y + 0.5);
            const float factor = finish.material.glows ? kGlow : light.at(uv);
            const Vector3f color = (255.0f * factor * surface_albedo(finish, uv, texture.texel)).cwiseMin(255.0f);
            for (std::size_t c = 0; c < 3; ++c)
                image.at(x, y)[c] = static_cast<std::uint8_t>(color[static_cast<int>(c)] + 0.5f);
        }
}

struct RowBlock {
    std::uint32_t surface;
    int begin, end;
};

std::vector<RowBlock> row_blocks(const std::vector<SurfaceTexture>& textures)
{
    constexpr int rows = 32;
    std::vector<RowBlock> blocks;
    for (std::uint32_t s = 0; s < textures.size(); ++s)
        for (int y = 0; y < textures[s].levels[0].height; y += rows)
            blocks.push_back({s, y, std::min(y + rows, textures[s].levels[0].height)});
    return blocks;
}

Vector3f bilinear(const ColorImage& image, double x, double y)
{
    return sample_color(image, std::clamp(x, 0.0, image.width - 1.001), std::clamp(y, 0.0, image.height - 1.001));
}

} // namespace

Vector3f SurfaceTexture::sample(const Vector2d& uv, double texels) const
{
    const double lod = texels > 1.0 ? std::min(std::log2(texels), kLevels - 1.0) : 0.0;
    const auto level = static_cast<std::size_t>(lod);
    const Vector2d at = (uv - corner) / texel;
    const auto from_level = [&](std::size_t l) {
        const double scale = 1.0 / static_cast<double>(1u << l);
        return bilinear(levels[l], at.x() * scale - 0.5, at.y() * scale - 0.5);
    };
    const auto t = static_cast<float>(lod - static_cast<double>(level));
    if (t == 0.0f) return from_level(level);
    return (1.0f - t) * from_level(level) + t * from_level(level + 1);
}

PaintedRoom paint_room(Room room, double texel)
{
    std::vector<Facet> facets = facets_of(room);
    PaintedRoom painted{std::move(room), facets, RayScene(facets), {}};
    const std::size_t surfaces = painted.room.planar.size() + painted.room.curved.size();
    const std::vector<TextureExtent> extents = texture_extents(facets, surfaces);
    std::vector<LightGrid> light(surfaces);
    Progress lighting("casting light", surfaces);
    parallel_for(surfaces, [&](std::size_t s) {
        light[s] = cast_light(painted.room, painted.facets, painted.rays, static_cast<std::uint32_t>(s), extents[s]);
        lighting.step();
    });
    for (const TextureExtent& extent : extents)
        painted.texture.push_back(empty_texture(extent, texel));
    const std::vector<RowBlock> blocks = row_blocks(painted.texture);
    Progress painting("painting surfaces", blocks.size());
    parallel_for(blocks.size(), [&](std::size_t i) {
        const RowBlock& b = blocks[i];
        paint_rows(painted.texture[b.surface], finish_of(painted.room, b.surface), light[b.surface], b.begin, b.end);
        painting.step();
    });
    parallel_for(surfaces, [&](std::size_t s) {
        auto& levels = painted.texture[s].levels;
        while (levels.size() < kLevels)
            levels.push_back(half_size(levels.back()));
    });
    return painted;
}

} // namespace quoin
