#include "metrics/texture_metrics.h"

#include "mesh/adjacency.h"
#include "metrics/seen_surface.h"
#include "metrics/surface.h"
#include "render/textured.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kHalfTexel = 0.5;

// The source of the texel that a point lies in.
TexelSource source_at(const TexturedModel& model, FaceId face, const Vector2d& texel)
{
    const Image<std::uint8_t>& source = model.pages()[model.mesh().face_page[face]].source;
    if (source.empty()) return TexelSource::Empty;
    const int x = std::clamp(static_cast<int>(std::lround(texel.x())), 0, source.width - 1),
              y = std::clamp(static_cast<int>(std::lround(texel.y())), 0, source.height - 1);
    return static_cast<TexelSource>(source.at(x, y));
}

double share_from(const std::vector<TexelSource>& sources, TexelSource source)
{
    return static_cast<double>(std::ranges::count(sources, source)) / static_cast<double>(sources.size());
}

void add_sources(MetricList& list, const TexturedModel& model, const Evaluated& inputs, const EvaluateParams& params)
{
    const auto samples = sample_surface(model.mesh().planes.mesh, static_cast<std::size_t>(params.samples));
    std::vector<TexelSource> sources;
    for (const SurfaceSample& s : samples)
        sources.push_back(source_at(model, s.face, model.texel(s.face, s.weights)));
    list.higher("texture.photograph", "", share_from(sources, TexelSource::Photograph));
    list.plain("texture.dense_mesh", "", share_from(sources, TexelSource::DenseMesh));
    list.plain("texture.filled", "", share_from(sources, TexelSource::Filled));
    list.lower("texture.empty", "", share_from(sources, TexelSource::Empty) + share_from(sources, TexelSource::Gutter));
    if (!inputs.scan || !inputs.images || !inputs.keyframes || !inputs.alignment) return;
    const auto seen = seen_by_keyframes(samples, inputs, params);
    std::vector<TexelSource> sources_of_seen;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (seen[i]) sources_of_seen.push_back(sources[i]);
    list.plain("texture.seen", "", static_cast<double>(sources_of_seen.size()) / static_cast<double>(samples.size()));
    list.higher("texture.photograph_of_seen", "", share_from(sources_of_seen, TexelSource::Photograph));
}

double area(const std::array<Vector2d, 3>& t)
{
    const Vector2d a = t[1] - t[0], b = t[2] - t[0];
    return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
}

std::array<Vector2d, 3> corner_texels(const TexturedModel& model, FaceId f)
{
    return {model.texel(f, Vector3d::UnitX()), model.texel(f, Vector3d::UnitY()), model.texel(f, Vector3d::UnitZ())};
}

void add_atlas(MetricList& list, const TexturedModel& model)
{
    const TriangleMesh& mesh = model.mesh().planes.mesh;
    double texels = 0.0, surface = 0.0, all = 0.0;
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        texels += area(corner_texels(model, f));
        surface += face_area(mesh, f);
    }
    for (const TexturePyramid& page : model.pages())
        all += static_cast<double>(page.level[0].pixels.size());
    list.higher("texture.atlas_use", "", texels / all);
    list.plain("texture.density", "px/m", std::sqrt(texels / surface));
}

double luma(const Vector3f& color) { return Vector3f(0.299f, 0.587f, 0.114f).dot(color); }

// Luma of a photographed point half a texel inside the face, `part` along its half-edge; nullopt for another source.
std::optional<double> luma_inside(const TexturedModel& model, std::uint32_t half_edge, double part)
{
    const FaceId f = half_edge / 3;
    const std::size_t k = half_edge % 3;
    const auto t = corner_texels(model, f);
    const Vector2d along = t[(k + 1) % 3] - t[k], to_third = t[(k + 2) % 3] - t[k];
    const Vector2d inward = to_third - along * (to_third.dot(along) / along.squaredNorm());
    const Vector2d at = t[k] + part * along + kHalfTexel * inward.normalized();
    if (!at.allFinite() || source_at(model, f, at) != TexelSource::Photograph) return std::nullopt;
    return luma(model.sample(f, at, 1.0));
}

// The differences across the edges that `counts`, at points `step` apart [m].
template <class Counts>
double median_step(const TexturedModel& model, const std::vector<std::uint32_t>& opposite, double step,
                   const Counts& counts)
{
    const TriangleMesh& mesh = model.mesh().planes.mesh;
    std::vector<double> differences;
    double to_next = 0.5 * step; // along all edges, one after the other
    for (std::uint32_t h = 0; h < opposite.size(); ++h) {
        if (!is_half_edge(opposite[h]) || opposite[h] < h || !counts(h, opposite[h])) continue;
        const double length =
            (corner(mesh, h / 3, static_cast<int>((h + 1) % 3)) - corner(mesh, h / 3, static_cast<int>(h % 3))).norm();
        const bool turns = mesh.face[h / 3][h % 3] == mesh.face[opposite[h] / 3][opposite[h] % 3];
        while (to_next < length) {
            const double part = to_next / length;
            const auto here = luma_inside(model, h, part);
            const auto there = luma_inside(model, opposite[h], turns ? part : 1.0 - part);
            if (here && there) differences.push_back(std::abs(*here - *there));
            to_next += step;
        }
        to_next -= length;
    }
    return median(std::move(differences));
}

void add_steps(MetricList& list, const TexturedModel& model, const EvaluateParams& params)
{
    const TexturedMesh& mesh = model.mesh();
    const auto opposite = opposite_half_edges(mesh.planes.mesh);
    const auto plane = [&](std::uint32_t h) { return mesh.planes.face_plane[h / 3]; };
    const auto lies_on_uv_of = [&](std::uint32_t h, std::uint32_t other) {
        const auto& corners = mesh.corner_uv[other / 3];
        return std::ranges::count(corners, mesh.corner_uv[h / 3][h % 3]) +
                   std::ranges::count(corners, mesh.corner_uv[h / 3][(h + 1) % 3]) ==
               2;
    };
    list.lower("texture.border_step", "",
               median_step(model, opposite, params.crease_step,
                           [&](std::uint32_t h, std::uint32_t other) { return plane(h) != plane(other); }));
    list.plain("texture.inner_step", "",
               median_step(model, opposite, params.crease_step, [&](std::uint32_t h, std::uint32_t other) {
                   return plane(h) == plane(other) && lies_on_uv_of(h, other);
               }));
}

} // namespace

void add_texture_metrics(MetricList& list, const Evaluated& inputs, const EvaluateParams& params)
{
    const TexturedModel model(*inputs.textured);
    add_sources(list, model, inputs, params);
    add_atlas(list, model);
    add_steps(list, model, params);
}

} // namespace quoin
