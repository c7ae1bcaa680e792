#include "bake/atlas.h"

#include "bake/packing.h"
#include "bake/triangle_raster.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quoin {
namespace {

// A bilinear look-up on the edge of a chart reaches texel centres up to the diagonal of a texel away.
constexpr double kTexelReach = 1.5; // [texel]

constexpr int kPageMultiple = 4; // block size of compressed textures

int block_size(const AtlasOptions& options) { return 1 << options.clean_mip_levels; } // [texel]

int blocks(double metres, const Chart& chart, int block)
{
    return std::max(1, static_cast<int>(std::ceil(metres * chart.density / block - kOnEdge)));
}

// A rectangle for the chart, without faces as yet. The chart's left and upper sides go through the centres of blocks:
// a look-up on them reads nothing beyond.
TexelChart lay_on_blocks(Chart chart, int block)
{
    const int columns = blocks(chart.extent.x(), chart, block), rows = blocks(chart.extent.y(), chart, block);
    chart.extent = Eigen::Vector2d(columns, rows) * block / chart.density;
    TexelChart texels{std::move(chart), 0, 0, 0, block / 2, {}, {}, BitMask(columns + 1, rows + 1)};
    const int width = texels.owned.width() * block, height = texels.owned.height() * block;
    texels.face = Image<std::uint32_t>(width, height, kNoFace);
    texels.inside = Image<std::uint8_t>(width, height, 0);
    return texels;
}

Triangle2 triangle_in(const TriangleMesh& mesh, const TexelChart& texels, FaceId f)
{
    Triangle2 triangle = chart_triangle(mesh, texels.chart, f);
    for (auto& p : triangle)
        p.array() += texels.margin;
    return triangle;
}

void assign_faces(const TriangleMesh& mesh, TexelChart& texels)
{
    Image<float> distance(texels.width(), texels.height(), std::numeric_limits<float>::infinity());
    for (std::uint32_t i = 0; i < texels.chart.face.size(); ++i) {
        const Triangle2 triangle = triangle_in(mesh, texels, texels.chart.face[i]);
        for_each_texel(triangle, texels.width(), texels.height(), kTexelReach, [&](int x, int y, double d) {
            if (static_cast<float>(d) >= distance.at(x, y)) return;
            distance.at(x, y) = static_cast<float>(d);
            texels.face.at(x, y) = i;
            texels.inside.at(x, y) = d <= kOnEdge;
        });
    }
}

// A look-up at p in the mip level of blocks reads those with centres less than a block away, along both axes; those
// that finer levels read are among them.
void own_blocks(const TriangleMesh& mesh, TexelChart& texels)
{
    const double block = 2.0 * texels.margin;
    for (const FaceId f : texels.chart.face) {
        Triangle2 triangle = triangle_in(mesh, texels, f);
        for (auto& p : triangle)
            p = (p.array() + 0.5) / block - 0.5; // block centres at integers
        const auto [low, high] = std::minmax({triangle[0].y(), triangle[1].y(), triangle[2].y()});
        for (int y = std::max(0, static_cast<int>(std::floor(low)));
             y <= std::min(texels.owned.height() - 1, static_cast<int>(std::ceil(high))); ++y) {
            const Span span = span_of_rows(triangle, y, 1.0);
            const int first = std::max(0, static_cast<int>(std::floor(span.low + kOnEdge)));
            const int last = std::min(texels.owned.width() - 1, static_cast<int>(std::ceil(span.high - kOnEdge)));
            for (int x = first; x <= last; ++x)
                texels.owned.set(x, y);
        }
    }
}

template <class Pixel>
Image<Pixel> turned(const Image<Pixel>& image)
{
    Image<Pixel> result(image.height, image.width);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            result.at(image.height - 1 - y, x) = image.at(x, y);
    return result;
}

void put_on_page(TexelChart& texels, const PlacedMask& place)
{
    for (int i = 0; i < place.turns; ++i) {
        turn(texels.chart);
        texels.face = turned(texels.face);
        texels.inside = turned(texels.inside);
        texels.owned = turned(texels.owned);
    }
    texels.page = place.page;
    texels.x = place.x * 2 * texels.margin;
    texels.y = place.y * 2 * texels.margin;
}

// With the densities that the charts have.
Atlas lay_out(const PlaneMesh& planes, std::vector<Chart> charts, const AtlasOptions& options)
{
    const int block = block_size(options), multiple = std::max(kPageMultiple, block);
    const int max_page = options.max_page / multiple * multiple;
    fit_charts(planes, charts, max_page - block, options.least_density);
    Atlas atlas;
    atlas.chart.resize(charts.size());
    parallel_for(charts.size(), [&](std::size_t c) {
        atlas.chart[c] = lay_on_blocks(std::move(charts[c]), block);
        assign_faces(planes.mesh, atlas.chart[c]);
        own_blocks(planes.mesh, atlas.chart[c]);
    });
    std::vector<BitMask> masks;
    for (const auto& texels : atlas.chart)
        masks.push_back(texels.owned);
    const Packing packing = pack_masks(masks, max_page / block, multiple / block);
    parallel_for(atlas.chart.size(), [&](std::size_t c) { put_on_page(atlas.chart[c], packing.mask[c]); });
    for (const auto& page : packing.page)
        atlas.page.push_back({page.width * block, page.height * block});
    atlas.face_chart.resize(planes.mesh.face.size());
    for (std::uint32_t c = 0; c < atlas.chart.size(); ++c)
        for (const FaceId f : atlas.chart[c].chart.face)
            atlas.face_chart[f] = c;
    return atlas;
}

double texels_of_faces(const PlaneMesh& planes, const std::vector<Chart>& charts)
{
    double texels = 0.0;
    for (const auto& chart : charts)
        for (const FaceId f : chart.face)
            texels += face_area(planes.mesh, f) * chart.density * chart.density;
    return texels;
}

} // namespace

Atlas lay_out_atlas(const PlaneMesh& planes, std::vector<Chart> charts, const AtlasOptions& options)
{
    constexpr int kRounds = 8; // gutters keep their width, whatever the density
    const auto lower_densities = [&](double texels) {
        for (auto& chart : charts)
            chart.density *= std::sqrt(options.max_texels / texels);
    };
    if (const double texels = texels_of_faces(planes, charts); texels > options.max_texels) lower_densities(texels);
    for (int round = 0;; ++round) {
        Atlas atlas = lay_out(planes, charts, options);
        const double texels = area_of(atlas.page);
        if (texels <= options.max_texels || round == kRounds) return atlas;
        lower_densities(texels);
    }
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
