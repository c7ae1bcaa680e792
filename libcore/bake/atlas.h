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

// A chart with its texels. The rectangle holds the chart and `margin` texels around it, and is made of whole blocks of
// 2 margin x 2 margin texels; texel (x, y) of the rectangle has its centre at ((x, y) + 0.5 - margin) / density in
// chart coordinates [m]. Rectangles may lie over each other on the page; the blocks that charts own do not.
struct TexelChart {
    Chart chart; // its extent is a whole number of blocks
    std::uint32_t page = 0;
    int x = 0, y = 0; // of the rectangle on the page [px], whole blocks
    int margin = 0;
    Image<std::uint32_t> face;  // of every texel of the rectangle, into chart.face; kNoFace outside. A texel just
                                // outside the chart has the nearest face, so that bilinear look-ups inside the chart
                                // meet known texels only.
    Image<std::uint8_t> inside; // 1 = the texel's centre is on a face of the chart
    BitMask owned;              // blocks that look-ups on the chart read, in full size or in any mip level down to that
                                // in which a block is a texel

    int width() const { return face.width; }
    int height() const { return face.height; }
    Eigen::Vector2d chart_point(double texel_x, double texel_y) const // [m]
    {
        return (Eigen::Vector2d(texel_x, texel_y).array() + 0.5 - margin) / chart.density;
    }
    // Texel coordinates of a world point, texel centres at integers.
    Eigen::Vector2d texel(const Eigen::Vector3d& p_world) const
    {
        return (chart.from_world(p_world) * chart.density).array() + margin - 0.5;
    }
};

struct Atlas {
    std::vector<TexelChart> chart;
    std::vector<PageSize> page;            // [px]
    std::vector<std::uint32_t> face_chart; // F, into chart
};

struct AtlasOptions {
    int clean_mip_levels = 1;   // below the full size; at least 1
    int max_page = 0;           // [px]
    double max_texels = 0.0;    // densities are lowered until all pages together have no more
    double least_density = 0.0; // a chart that is longer than a page gets no less before it is cut [1/m]
};

// Cuts charts that are too long, packs them and finds the face of every texel. Charts come with their density. No
// look-up on a chart, bilinear in a box-filtered mip level up to the last clean one, reads another chart's texels.
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
