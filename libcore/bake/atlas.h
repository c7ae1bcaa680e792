// The atlas: where every chart lies on the pages, and which face every texel belongs to.
#pragma once

#include "bake/charts.h"
#include "bake/packing.h"

#include "image/image.h"
#include "render/rasterize.h"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace quoin {

// A chart with its texels. The rectangle holds the chart and a gutter of `gutter` texels around it; texel (x, y) of the
// rectangle has its centre at ((x, y) + 0.5 - gutter) / density in chart coordinates [m].
struct TexelChart {
    Chart chart;
    std::uint32_t page = 0;
    int x = 0, y = 0; // of the rectangle on the page [px]
    int gutter = 0;
    Image<std::uint32_t> face;  // of every texel of the rectangle, into chart.face; kNoFace outside. A texel just
                                // outside the chart has the nearest face, so that bilinear look-ups inside the chart
                                // meet known texels only.
    Image<std::uint8_t> inside; // 1 = the texel's centre is on a face of the chart

    int width() const { return face.width; }
    int height() const { return face.height; }
    Eigen::Vector2d chart_point(double texel_x, double texel_y) const // [m]
    {
        return (Eigen::Vector2d(texel_x, texel_y).array() + 0.5 - gutter) / chart.density;
    }
    // Texel coordinates of a world point, texel centres at integers.
    Eigen::Vector2d texel(const Eigen::Vector3d& p_world) const
    {
        return (chart.from_world(p_world) * chart.density).array() + gutter - 0.5;
    }
};

struct Atlas {
    std::vector<TexelChart> chart;
    std::vector<RectangleSize> page;
    std::vector<std::uint32_t> face_chart; // F, into chart
};

struct AtlasOptions {
    int gutter = 0;             // [px]
    int max_page = 0;           // [px], a multiple of 4
    double max_texels = 0.0;    // densities are lowered until all rectangles together have no more
    double least_density = 0.0; // a chart that is longer than a page gets no less before it is cut [1/m]
};

// Cuts charts that are too long, packs them and finds the face of every texel. Charts come with their density.
Atlas lay_out_atlas(const PlaneMesh& planes, std::vector<Chart> charts, const AtlasOptions& options);

// Where the texels of a chart are in the world: the point of their face, extended beyond its edges, on the line through
// the texel along the chart's normal.
class TexelPositions {
public:
    TexelPositions(const PlaneMesh& planes, const TexelChart& texels);
    // `face` indexes the chart's faces.
    Eigen::Vector3d world(std::uint32_t face, double texel_x, double texel_y) const; // [m]
    const Eigen::Vector3d& normal(std::uint32_t face) const { return surface_[face].normal; }

private:
    struct Surface {
        Eigen::Vector3d normal; // unit, world
        Eigen::Vector3d height; // (a, b, c): height over the chart = a u + b v + c [m]
    };
    const TexelChart* texels_;
    std::vector<Surface> surface_; // one per face of the chart
};

} // namespace quoin
