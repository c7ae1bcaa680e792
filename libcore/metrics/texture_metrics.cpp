#include "metrics/texture_metrics.h"

#include "metrics/border_metrics.h"
#include "metrics/seen_surface.h"
#include "metrics/surface.h"
#include "metrics/texel_source.h"
#include "render/textured.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

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
    if (!inputs.can_look_from_keyframes()) return;
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

} // namespace

void add_texture_metrics(MetricList& list, const Evaluated& inputs, const EvaluateParams& params)
{
    const TexturedModel model(*inputs.textured);
    add_sources(list, model, inputs, params);
    add_atlas(list, model);
    add_border_metrics(list, model, inputs, params);
}

} // namespace quoin
