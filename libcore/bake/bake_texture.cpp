#include "bake/bake_texture.h"

#include "bake/atlas.h"
#include "bake/blend.h"
#include "bake/density.h"
#include "bake/fill.h"
#include "bake/level_seams.h"
#include "bake/pages.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"

#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <string>

namespace quoin {
namespace {

constexpr double kMega = 1e6;

void check(const BakeInput& input)
{
    const auto expect = [](const std::string& what, std::size_t found, std::size_t expected) {
        if (found != expected)
            throw InputError(what + ": found " + std::to_string(found) + ", expected " + std::to_string(expected) +
                             "; give the artifacts of one pipeline run");
    };
    const std::size_t count = input.keyframes.frame.size();
    expect("poses in the alignment, one per keyframe", input.alignment.camera_from_world.size(), count);
    expect("gains in the alignment, one per keyframe", input.alignment.gain.size(), count);
    expect("biases in the alignment, one per keyframe", input.alignment.bias.size(), count);
    expect("planes of faces, one per face", input.planes.face_plane.size(), input.planes.mesh.face.size());
    for (const FrameId id : input.keyframes.frame)
        if (id >= input.images.scan().frames.size())
            throw InputError("keyframe " + std::to_string(id) + " is not in the scan of " +
                             std::to_string(input.images.scan().frames.size()) + " frames");
    if (input.planes.mesh.face.empty())
        throw ImpossibleError("the plane mesh has no faces; there is nothing to texture");
}

void report(const Atlas& atlas, const AtlasOptions& options)
{
    double texels = 0.0;
    for (const PageSize& page : atlas.page)
        texels += static_cast<double>(page.width) * page.height;
    log_info(fmt::format("{} charts on {} pages of at most {} px; {:.1f} million texels", atlas.chart.size(),
                         atlas.page.size(), options.max_page, texels / kMega));
}

Atlas make_atlas(const BakeInput& input, const BakeTextureParams& params)
{
    auto charts = make_charts(input.planes, std::cos(params.max_view_angle * std::numbers::pi / 180.0));
    set_densities(charts, input.planes, input.alignment, params);
    split_overlaps(input.planes, charts);
    const AtlasOptions options{params.clean_mip_levels, params.max_page_size, params.max_megatexels * kMega,
                               params.density};
    Atlas atlas = lay_out_atlas(input.planes, std::move(charts), options);
    report(atlas, options);
    return atlas;
}

void fill_unseen(const BakeInput& input, const Atlas& atlas, const BakeTextureParams& params,
                 std::vector<ChartColors>& colors)
{
    if (input.dense && !input.dense->color.empty()) {
        const DenseColors dense_colors(*input.dense, params.dense_radius);
        parallel_for(colors.size(),
                     [&](std::size_t c) { fill_from_dense(input.planes, atlas.chart[c], dense_colors, colors[c]); });
    }
    fill_rest(input.planes, atlas, colors);
}

// One uv per vertex of a chart.
void set_uv(const Atlas& atlas, TexturedMesh& textured)
{
    const TriangleMesh& mesh = textured.planes.mesh;
    textured.corner_uv.resize(mesh.face.size());
    textured.face_page.resize(mesh.face.size());
    std::vector<std::uint32_t> uv_of_vertex(mesh.position.size()), chart_of_uv(mesh.position.size(), kNoFace);
    for (std::uint32_t c = 0; c < atlas.chart.size(); ++c) {
        const TexelChart& texels = atlas.chart[c];
        const Eigen::Array2d page(atlas.page[texels.page].width, atlas.page[texels.page].height);
        const auto add_uv = [&](VertexId v) {
            chart_of_uv[v] = c;
            uv_of_vertex[v] = static_cast<std::uint32_t>(textured.uv.size());
            const Eigen::Array2d pixel =
                texels.texel(mesh.position[v].cast<double>()).array() + Eigen::Array2d(texels.x, texels.y);
            textured.uv.emplace_back(((pixel + 0.5) / page).cast<float>());
        };
        for (const FaceId f : texels.chart.face) {
            textured.face_page[f] = texels.page;
            for (std::size_t k = 0; k < 3; ++k) {
                const VertexId v = mesh.face[f][k];
                if (chart_of_uv[v] != c) add_uv(v);
                textured.corner_uv[f][k] = uv_of_vertex[v];
            }
        }
    }
}

} // namespace

TexturedMesh bake_texture(const BakeInput& input, const BakeTextureParams& params)
{
    check(input);
    const Atlas atlas = make_atlas(input, params);
    auto colors = blend_views(atlas, input, params);
    fill_unseen(input, atlas, params, colors);
    if (params.seam_width > 0.0)
        level_seams(input.planes, atlas, {params.seam_width, params.band_width, params.seam_step}, colors);

    TexturedMesh textured;
    textured.planes = input.planes;
    set_uv(atlas, textured);
    textured.page = encode_pages(atlas, colors, params);
    return textured;
}

} // namespace quoin
