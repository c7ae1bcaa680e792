#include "bake/atlas.h"

#include "bake/triangle_raster.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

// A bilinear look-up on the edge of a chart reaches texel centres up to the diagonal of a texel away.
constexpr double kTexelReach = 1.5; // [texel]

RectangleSize rectangle_size(const Chart& chart, int gutter)
{
    const auto side = [&](double metres) {
        return std::max(1, static_cast<int>(std::ceil(metres * chart.density))) + 2 * gutter;
    };
    return {side(chart.extent.x()), side(chart.extent.y())};
}

// One factor for all densities, so that the rectangles fit in the budget; gutters keep their width, hence the rounds.
void limit_texels(std::vector<Chart>& charts, const AtlasOptions& options)
{
    constexpr int kRounds = 8;
    for (int round = 0; round < kRounds; ++round) {
        double texels = 0.0;
        for (const auto& chart : charts) {
            const auto size = rectangle_size(chart, options.gutter);
            texels += static_cast<double>(size.width) * size.height;
        }
        if (texels <= options.max_texels) return;
        for (auto& chart : charts)
            chart.density *= std::sqrt(options.max_texels / texels);
    }
}

void assign_faces(const TriangleMesh& mesh, TexelChart& texels)
{
    Image<float> distance(texels.width(), texels.height(), std::numeric_limits<float>::infinity());
    for (std::uint32_t i = 0; i < texels.chart.face.size(); ++i) {
        Triangle2 triangle = chart_triangle(mesh, texels.chart, texels.chart.face[i]);
        for (auto& p : triangle)
            p.array() += texels.gutter;
        for_each_texel(triangle, texels.width(), texels.height(), kTexelReach, [&](int x, int y, double d) {
            if (static_cast<float>(d) >= distance.at(x, y)) return;
            distance.at(x, y) = static_cast<float>(d);
            texels.face.at(x, y) = i;
            texels.inside.at(x, y) = d <= kOnEdge;
        });
    }
}

} // namespace

Atlas lay_out_atlas(const PlaneMesh& planes, std::vector<Chart> charts, const AtlasOptions& options)
{
    limit_texels(charts, options);
    fit_charts(planes, charts, options.max_page - 2 * options.gutter, options.least_density);
    std::vector<RectangleSize> sizes;
    for (const auto& chart : charts)
        sizes.push_back(rectangle_size(chart, options.gutter));
    const Packing packing = pack_rectangles(sizes, options.max_page);

    Atlas atlas;
    atlas.page = packing.page;
    atlas.face_chart.resize(planes.mesh.face.size());
    for (std::uint32_t c = 0; c < charts.size(); ++c) {
        for (const FaceId f : charts[c].face)
            atlas.face_chart[f] = c;
        const auto& place = packing.rectangle[c];
        if (place.turned) turn(charts[c]);
        atlas.chart.push_back({std::move(charts[c]), place.page, place.x, place.y, options.gutter, {}, {}});
    }
    parallel_for(atlas.chart.size(), [&](std::size_t c) {
        auto& texels = atlas.chart[c];
        const auto size = rectangle_size(texels.chart, options.gutter);
        texels.face = Image<std::uint32_t>(size.width, size.height, kNoFace);
        texels.inside = Image<std::uint8_t>(size.width, size.height, 0);
        assign_faces(planes.mesh, texels);
    });
    return atlas;
}

TexelPositions::TexelPositions(const PlaneMesh& planes, const TexelChart& texels) : texels_(&texels)
{
    const Chart& chart = texels.chart;
    const Eigen::Vector3d up = chart.normal();
    for (const FaceId f : chart.face) {
        Surface surface{face_normal(planes.mesh, f), Eigen::Vector3d::Zero()};
        if (surface.normal.isZero()) surface.normal = up; // a face without area lies flat at its first corner
        const double slope = surface.normal.dot(up);      // >= min_facing by the making of charts
        const Eigen::Vector3d from_origin = corner(planes.mesh, f, 0) - chart.origin;
        surface.height << -surface.normal.dot(chart.axis_u), -surface.normal.dot(chart.axis_v),
            surface.normal.dot(from_origin);
        surface.height /= slope;
        surface_.push_back(surface);
    }
}

Eigen::Vector3d TexelPositions::world(std::uint32_t face, double texel_x, double texel_y) const
{
    const Chart& chart = texels_->chart;
    const Eigen::Vector2d m = texels_->chart_point(texel_x, texel_y);
    const Eigen::Vector3d& h = surface_[face].height;
    return chart.origin + m.x() * chart.axis_u + m.y() * chart.axis_v +
           (h.x() * m.x() + h.y() * m.y() + h.z()) * chart.normal();
}

} // namespace quoin
